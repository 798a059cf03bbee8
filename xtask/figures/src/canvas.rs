//! A figure as SVG and PNG, with its font inside.
//!
//! plotters rounds coordinates to whole pixels, so figures are drawn `FINE` times as large as they are shown.

use crate::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use resvg::{tiny_skia, usvg};
use std::path::Path;
use std::sync::Arc;

/// What figures are drawn on.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Units of the drawing in a pixel of the SVG.
const FINE: i32 = 8;
/// Pixels of the PNG in a pixel of the SVG.
const DENSE: f32 = 2.0;
/// plotters divides font sizes by this before it writes them.
const FONT_UNIT: f64 = 1.24;

const FAMILY: &str = "DejaVu Sans";
const REGULAR: &[u8] = include_bytes!("../assets/DejaVuSans.subset.ttf");
const BOLD: &[u8] = include_bytes!("../assets/DejaVuSans-Bold.subset.ttf");

/// Colours that colour-blind people can tell apart (Okabe & Ito 2008); the same thing has the same colour in all
/// figures.
pub mod colour {
    use plotters::style::RGBColor;
    pub const INK: RGBColor = RGBColor(40, 40, 40);
    pub const FAINT: RGBColor = RGBColor(130, 130, 130);
    pub const GRID: RGBColor = RGBColor(228, 228, 228);
    pub const GROUND: RGBColor = RGBColor(236, 232, 226);
    pub const TARGET: RGBColor = RGBColor(0, 158, 115);
    pub const NORMAL: RGBColor = RGBColor(204, 41, 41);
    pub const PATH: RGBColor = RGBColor(0, 92, 158);
    /// The paper's move.
    pub const PAPER: RGBColor = RGBColor(204, 96, 0);
    /// The default moves.
    pub const OURS: RGBColor = RGBColor(0, 114, 178);
}

/// A length of `pixels` in units of the drawing.
pub fn px(pixels: f64) -> i32 {
    (pixels * f64::from(FINE)).round() as i32
}

/// A line of `pixels` width.
pub fn pen(colour: RGBColor, pixels: f64) -> ShapeStyle {
    ShapeStyle { color: colour.into(), filled: false, stroke_width: px(pixels) as u32 }
}

/// Text of `pixels` height.
pub fn text(pixels: f64, colour: RGBColor) -> TextStyle<'static> {
    (FAMILY, f64::from(px(pixels)) * FONT_UNIT).into_font().color(&colour)
}

/// Bold text.
pub fn bold(pixels: f64, colour: RGBColor) -> TextStyle<'static> {
    (FAMILY, f64::from(px(pixels)) * FONT_UNIT).into_font().style(FontStyle::Bold).color(&colour)
}

/// Writes `words` at `at`, in pixels from the corner of `area`; `align` says which point of the words is at `at`.
pub fn write(area: &Area<'_>, words: &str, style: &TextStyle<'_>, align: HPos, at: (f64, f64)) -> Result<()> {
    let style = style.pos(plotters::style::text_anchor::Pos::new(align, VPos::Center));
    area.draw(&Text::new(words.to_owned(), (px(at.0), px(at.1)), style)).map_err(|error| error.to_string())?;
    Ok(())
}

pub use plotters::style::text_anchor::{HPos, VPos};

/// A picture in a figure: the place of its upper left corner and its width, in pixels of the figure.
pub struct Picture {
    pub at: (f64, f64),
    pub width: f64,
    pub image: tiny_skia::Pixmap,
}

/// Draws a figure of `size` pixels and saves it as `name.svg` and `name.png`.
pub fn save(folder: &Path, name: &str, size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Result<()>) -> Result<()> {
    save_with(folder, name, size, &[], draw)
}

/// The same, with pictures laid over the drawing.
pub fn save_with(
    folder: &Path,
    name: &str,
    size: (u32, u32),
    pictures: &[Picture],
    draw: impl FnOnce(&Area<'_>) -> Result<()>,
) -> Result<()> {
    let mut svg = String::new();
    let fine = FINE as u32;
    {
        let area = SVGBackend::with_string(&mut svg, (size.0 * fine, size.1 * fine)).into_drawing_area();
        area.fill(&WHITE).map_err(|error| error.to_string())?;
        draw(&area)?;
        area.present().map_err(|error| error.to_string())?;
    }
    let svg = finish(&svg, size)?;
    let save = |ending: &str, bytes: &[u8]| {
        let path = folder.join(format!("{name}.{ending}"));
        std::fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))
    };
    save("png", &png(&svg, pictures)?)?;
    save("svg", embed(&svg, pictures)?.as_bytes())?;
    Ok(())
}

/// The drawing at its size, with the font inside and a fallback after it.
fn finish(svg: &str, size: (u32, u32)) -> Result<String> {
    let fine = FINE as u32;
    let large = format!(r#"width="{}" height="{}""#, size.0 * fine, size.1 * fine);
    let shown = format!(r#"width="{}" height="{}""#, size.0, size.1);
    let end = svg.find('>').ok_or("plotters wrote no SVG")? + 1;
    let head = svg[..end].replacen(&large, &shown, 1);
    let face = |weight: &str, font: &[u8]| {
        format!(
            "@font-face{{font-family:\"{FAMILY}\";font-weight:{weight};src:url(data:font/ttf;base64,{}) format(\"truetype\")}}\n",
            base64(font)
        )
    };
    let style = format!("\n<style>\n{}{}</style>", face("normal", REGULAR), face("bold", BOLD));
    let body = svg[end..]
        .replace(&format!("font-family=\"{FAMILY}\""), &format!("font-family=\"'{FAMILY}', Verdana, sans-serif\""));
    Ok(head + &style + &body)
}

/// The drawing with pictures at its end.
fn embed(svg: &str, pictures: &[Picture]) -> Result<String> {
    let end = svg.rfind("</svg>").ok_or("plotters wrote no SVG")?;
    let mut text = svg[..end].to_owned();
    for Picture { at, width, image } in pictures {
        let height = width * f64::from(image.height()) / f64::from(image.width());
        let [x, y, w, h] = [at.0, at.1, *width, height].map(px);
        let data = base64(&image.encode_png()?);
        text += &format!(r#"<image x="{x}" y="{y}" width="{w}" height="{h}" href="data:image/png;base64,{data}"/>"#);
        text.push('\n');
    }
    Ok(text + &svg[end..])
}

fn png(svg: &str, pictures: &[Picture]) -> Result<Vec<u8>> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(REGULAR.to_vec());
    fonts.load_font_data(BOLD.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    let options = usvg::Options { fontdb: Arc::new(fonts), font_family: FAMILY.to_owned(), ..Default::default() };
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size();
    let (width, height) = ((size.width() as f32 * DENSE) as u32, (size.height() as f32 * DENSE) as u32);
    let mut image = tiny_skia::Pixmap::new(width, height).ok_or("a figure without pixels")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(DENSE, DENSE), &mut image.as_mut());
    let paint = tiny_skia::PixmapPaint { quality: tiny_skia::FilterQuality::Bilinear, ..Default::default() };
    for picture in pictures {
        let scale = picture.width as f32 * DENSE / picture.image.width() as f32;
        let place = tiny_skia::Transform::from_translate(picture.at.0 as f32 * DENSE, picture.at.1 as f32 * DENSE);
        image.draw_pixmap(0, 0, picture.image.as_ref(), &paint, place.pre_scale(scale, scale), None);
    }
    Ok(image.encode_png()?)
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = group.iter().enumerate().fold(0_u32, |word, (i, &byte)| word | u32::from(byte) << (16 - 8 * i));
        for place in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= group.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    #[test]
    fn base64_is_that_of_the_standard() {
        let vectors = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|word| super::base64(word.as_bytes()));
        assert_eq!(vectors, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
    }
}
