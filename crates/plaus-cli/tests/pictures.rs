//! Pictures and videos as the program writes them.

use crate::common::Place;
use std::os::unix::fs::PermissionsExt;

fn sampled() -> Place {
    let place = Place::new();
    place.ok("sample ball.toml --out run -q");
    place
}

/// A program in place of ffmpeg.
fn encoder(place: &Place, script: &str) -> std::path::PathBuf {
    place.write("encoder", format!("#!/bin/sh\n{script}\n"));
    let path = place.path("encoder");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn pictures_have_the_size_that_is_asked_for() {
    let place = sampled();
    place.ok("export run --format png --size 48x27 --sample 1:7 --out a.png");
    let png = std::fs::read(place.path("a.png")).unwrap();
    assert_eq!(&png[16..24], &[0, 0, 0, 48, 0, 0, 0, 27], "width and height of the header");
    place.ok("export run --format png --size 48x27 --sample 1:7 --out from-behind.png --view=0,1,0.5");
    assert!(std::fs::read(place.path("from-behind.png")).unwrap() != png, "another view is another picture");
    place.ok("export run --format gif --size 48x27 --sample 1:7 --sample 0:3 --fps 10 --into two.gif");
    let gif = std::fs::read(place.path("two.gif")).unwrap();
    assert_eq!(&gif[..10], b"GIF89a\x30\0\x1b\0");
    for (arguments, says) in [
        ("--format png --size 48", "write WIDTHxHEIGHT"),
        ("--format png --view 1,2", "write X,Y,Z with z up"),
        ("--format png --view 0,-1,0.5,left", "write X,Y,Z with z up"),
        ("--format png --view 0,0,1", "give it a level part"),
        ("--format glb --view 1,2,3", "--view goes with png and gif and mp4, not with glb"),
        ("--format png --size 8x9", "8x9 pixels: must be from 16 to 16384 each"),
        ("--format glb --size 48x27", "--size goes with png and gif and mp4, not with glb"),
        ("--format mp4 --size 47x27", "47x27 pixels: videos need even numbers"),
    ] {
        let format = arguments.split(' ').nth(1).unwrap();
        place.ends(&format!("export run {arguments} --sample 1:7 --out x.{format}"), 2).says(&[says]);
        assert!(!place.path(&format!("x.{format}")).exists());
    }
}

/// A gallery is titled with its scenario and the keys that were set.
#[test]
fn a_gallery_names_what_was_set() {
    let place = Place::new();
    place.ok("sample ball.toml --set sampler.seed=7 --out run -q");
    place.ok("gallery run --count 1 --out g.html");
    let page = std::fs::read_to_string(place.path("g.html")).unwrap();
    assert!(page.contains("<title>ball2d · ball.toml --set sampler.seed=7 · plaus</title>"));
}

/// The delays of a loop's frames, in hundredths of a second.
fn delays(gif: &[u8]) -> Vec<u16> {
    // A graphic control extension: its introducer, label and length, flags, and the delay.
    let heads = gif.windows(6).filter(|bytes| bytes[..3] == [0x21, 0xf9, 4]);
    heads.map(|bytes| u16::from_le_bytes([bytes[4], bytes[5]])).collect()
}

/// A motion of 0.4 s takes 1.6 s in a loop, one of 0.9 s twice as long; the end stays.
#[test]
fn a_loop_shows_what_is_short_slowly_and_holds_its_end() {
    let place = sampled();
    for (until, frames) in [(0.4, 17), (0.7, 29), (0.9, 19)] {
        let range = format!("--time-range 0:{until}");
        place.ok(&format!("export run --format gif --size 16x16 --fps 10 {range} --sample 1:7 --out l.gif --force"));
        let delays = delays(&std::fs::read(place.path("l.gif")).unwrap());
        assert_eq!(delays.len(), frames, "{until}");
        assert!(delays[..frames - 1].iter().all(|delay| *delay == 10) && delays[frames - 1] == 110, "{delays:?}");
    }
}

#[test]
fn a_video_is_what_the_encoder_makes_of_all_frames() {
    let place = sampled();
    // It writes what it receives to its last argument, and says where its sound comes from.
    let made = encoder(&place, r#"for last; do :; done; { printf '\0\0\0plaus '; wc -c | tr -d ' \n'; } > "$last""#);
    let export = "export run --format mp4 --size 32x18 --fps 10 --time-range 0.1:0.55 --sample 1:7 --out v.mp4";
    let run = || place.command(export).env("PLAUS_FFMPEG", &made).output().unwrap();
    let output = run();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let video = std::fs::read_to_string(place.path("v.mp4")).unwrap();
    // From 0.1 s to 0.55 s: frames at 0, 0.1, … 0.4 s after the beginning, and one at the end.
    assert_eq!(video, format!("\0\0\0plaus {}", 6 * 32 * 18 * 3));
    assert_eq!(place.names(), ["ball.toml", "encoder", "run", "v.mp4"], "no sound and no half a video is left");
}

#[test]
fn an_encoder_that_fails_or_is_missing_leaves_nothing() {
    let place = sampled();
    let export = "export run --format mp4 --size 32x18 --fps 10 --sample 1:7 --out v.mp4";
    let made = encoder(&place, "echo 'no such codec' >&2; exit 1");
    for (program, says) in
        [(made, "no such codec"), ("no/such/ffmpeg".into(), "install it, or name it in PLAUS_FFMPEG")]
    {
        let output = place.command(export).env("PLAUS_FFMPEG", program).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(says), "{output:?}");
        assert_eq!(place.names(), ["ball.toml", "encoder", "run"]);
    }
}
