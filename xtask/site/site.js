// Dark or light, the loop's pause, and the search: nothing is asked of any server.
'use strict';
const root = document.documentElement, at = document.currentScript.dataset.root;
const remembered = { get theme() { try { return localStorage.theme; } catch { return null; } }, set theme(name) { try { localStorage.theme = name; } catch { /* not remembered */ } } };
root.dataset.theme = remembered.theme ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');

document.addEventListener('DOMContentLoaded', () => {
  const one = (id) => document.getElementById(id), input = one('query'), list = one('found');
  one('theme').addEventListener('click', () => { remembered.theme = root.dataset.theme = root.dataset.theme === 'dark' ? 'light' : 'dark'; });
  const narrow = matchMedia('(max-width: 800px)'), pages = document.querySelector('.doc details');
  const fold = () => { if (pages) pages.open = !narrow.matches; };
  narrow.addEventListener('change', fold), fold();

  const loop = one('pause');
  loop?.addEventListener('click', () => {
    const image = document.querySelector('#loop img'), is_still = image.src.endsWith(image.dataset.still);
    document.querySelector('#loop source')?.remove(); // asked for, it moves though less motion is preferred
    image.src = is_still ? image.dataset.loop : image.dataset.still;
    loop.textContent = is_still ? 'Pause' : 'Play';
  });
  if (loop && matchMedia('(prefers-reduced-motion: reduce)').matches) { const image = document.querySelector('#loop img'); image.src = image.dataset.still, loop.textContent = 'Play'; }

  let index = null;
  const load = () => index ??= new Promise((done) => {
    const script = Object.assign(document.createElement('script'), { src: `${at}search-index.js`, onload: () => done(window.sections) });
    document.head.append(script);
  });
  async function search() {
    const words = input.value.toLowerCase().match(/[\p{L}\p{N}_.]+/gu) ?? [];
    list.hidden = !words.length;
    if (!words.length) return;
    const times = (text, word) => text.toLowerCase().split(word).length - 1;
    // A word in a heading counts as much as many in the text; every word must be there.
    const scored = (await load()).map((section) => {
      const each = words.map((word) => 12 * times(section.heading, word) + 6 * times(section.page, word) + Math.min(times(section.text, word), 5));
      return [each.every((score) => score) ? each.reduce((a, b) => a + b) : 0, section];
    }).filter(([score]) => score).sort(([a], [b]) => b - a).slice(0, 12);
    list.replaceChildren(...scored.map(([, section]) => {
      const [item, link, small] = ['li', 'a', 'small'].map((name) => document.createElement(name));
      const from = Math.max(0, section.text.toLowerCase().indexOf(words[0]) - 50);
      link.href = at + section.url;
      small.textContent = `${section.page === section.heading ? '' : `${section.page}: `}${section.text.slice(from, from + 130)}`;
      link.append(section.heading, small), item.append(link);
      return item;
    }));
    if (!scored.length) list.append(Object.assign(document.createElement('li'), { innerHTML: '<p>Nothing is found.</p>' }));
    one('count').textContent = `${scored.length} found`;
  }
  input.addEventListener('input', search);
  input.addEventListener('focus', load);
  document.addEventListener('click', ({ target }) => { if (!target.closest('#search')) list.hidden = true; });
  document.addEventListener('keydown', (event) => {
    const links = [...list.querySelectorAll('a')], here = links.indexOf(document.activeElement);
    if (event.key === '/' && !event.target.closest('input, textarea')) input.focus(), event.preventDefault();
    else if (event.key === 'Escape') list.hidden = true;
    else if (!list.hidden && ['ArrowDown', 'ArrowUp'].includes(event.key)) (links[here + (event.key === 'ArrowDown' ? 1 : -1)] ?? input).focus(), event.preventDefault();
    else if (!list.hidden && event.key === 'Enter' && event.target === input) links[0]?.click();
  });
});
