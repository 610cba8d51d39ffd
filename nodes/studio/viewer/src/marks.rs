//! Length and directions in a picture.

use crate::canvas::Canvas;
use crate::raster::frame;

/// Part of the width that a scale bar has at most.
const PART: f64 = 0.18;

/// The longest length of 1, 2 or 5 in a decade that is at most this one, m, as text.
pub(crate) fn round_length(most: f64) -> (f64, String) {
    let units = [(1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")];
    let (unit, name) = units.into_iter().find(|(unit, _)| most >= *unit).unwrap_or(units[4]);
    let steps = [500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0];
    let count = steps.into_iter().find(|count| most >= count * unit).unwrap_or(1.0);
    (count * unit, format!("{count} {name}"))
}

/// A scale bar with its lower right corner; `scale` is in pixels a metre.
pub(crate) fn scale_bar(canvas: &mut Canvas, scale: f64, [right, bottom]: [f64; 2]) {
    let (length, text) = round_length(PART * canvas.width as f64 / scale);
    let (letters, width) = (canvas.letters, (length * scale).round());
    let (line, left) = (letters.line() as f64, right - width);
    // The ends are straight: round caps would lie outside of the length.
    let (thick, ink) = ((0.16 * line).round().max(1.0), canvas.ink);
    canvas.fill([left, bottom - 1.5 * thick].map(|v| v as usize), [width, thick].map(|v| v as usize), ink);
    let at = [left + 0.5 * (width - letters.width_of(&text) as f64), bottom - 1.5 * line];
    canvas.write(&text, at.map(|v| v.round().max(0.0) as usize));
}

/// The directions of x, y and z, with the right end and the bottom of their letters.
pub(crate) fn triad(canvas: &mut Canvas, [right, bottom]: [f64; 2]) {
    let [to_right, up, _] = frame();
    let (letters, line) = (canvas.letters, canvas.letters.line() as f64);
    let origin = [right - 2.0 * line, bottom - 1.4 * line];
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        let end = |length: f64| [origin[0] + length * to_right[k], origin[1] - length * up[k]];
        canvas.line([origin, end(1.5 * line)], 0.09 * line);
        let at = end(1.95 * line);
        let at = [at[0] - 0.5 * letters.width_of(name) as f64, at[1] - 0.45 * line];
        canvas.write(name, at.map(|v| v.round().max(0.0) as usize));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Ground;
    use crate::lettering::Lettering;

    #[test]
    fn a_scale_bar_is_as_long_as_it_says_to_a_pixel() {
        for scale in [31_234.0, 8_765.4, 150.0] {
            let (width, height) = (800, 600);
            let pixels = vec![0; 4 * width * height];
            let mut canvas = Canvas::new([width, height], Ground::Clear, Lettering::of(height), pixels);
            scale_bar(&mut canvas, scale, [790.0, 590.0]);
            let inked = |row: &[u8]| row.chunks_exact(4).filter(|pixel| pixel[3] > 0).count();
            let bar = canvas.pixels.chunks_exact(4 * width).map(inked).rfind(|n| *n > 0).unwrap();
            let length = round_length(PART * width as f64 / scale).0 * scale;
            assert!((bar as f64 - length).abs() <= 0.5, "{bar} pixels for {length}");
        }
    }

    #[test]
    fn a_scale_bar_is_1_2_or_5_of_a_decade_and_at_most_as_long_as_its_room() {
        let of = |most: f64| round_length(most).1;
        let texts = [0.9e-3, 1e-3, 4.9e-4, 0.06, 3.0, 7e-8].map(of);
        assert_eq!(texts, ["500 µm", "1 mm", "200 µm", "50 mm", "2 m", "50 nm"]);
        assert!([1.3e-9, 2e-6, 0.19, 5e5].iter().all(|most| round_length(*most).0 <= *most));
    }
}
