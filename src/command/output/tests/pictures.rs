//! Goal: every picture is well-formed, says what it shows, and draws whatever the data are.

use crate::output::{
    Curve, CurvePoint, FieldPanel, Line, LineAxis, LineCaptions, LinePanel, draw_fields, draw_grid_of_fields,
    draw_lines, draw_study,
};

/// Parses a picture: tags balance, every number is a number, no markup leaks from texts.
pub(super) fn check(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, text) = tag
            .split_once('>')
            .unwrap_or_else(|| panic!("tag without end: {tag}"));
        assert!(!text.contains('>') && tag.matches('"').count() % 2 == 0, "{tag}");
        let name = tag
            .split([' ', '/'])
            .find(|word| !word.is_empty())
            .unwrap_or_default();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(name);
        }
        assert!(!["NaN", "inf"].iter().any(|bad| tag.contains(bad)), "{tag}");
    }
    assert!(open.is_empty() && svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
}

fn panel(particles: &[(f64, f64)], reference: &[(f64, f64)]) -> FieldPanel {
    FieldPanel {
        name: "stress <x> & y".into(),
        unit: "Pa".into(),
        particles: particles.to_vec(),
        reference: reference.to_vec(),
        note: "relative L2 error 7.59e-3".into(),
    }
}

fn curve(points: &[(f64, f64)]) -> Curve {
    let point = |&(x, y): &(f64, f64)| CurvePoint {
        x,
        y,
        label: "20 cells".into(),
        on_front: true,
    };
    Curve {
        label: "linear + <Taylor>".into(),
        family: 7,
        variant: 9,
        points: points.iter().map(point).collect(),
    }
}

/// Lines that stop, before a reference and a shade.
fn lines(title: &str, axis: LineAxis, points: &[(f64, f64)], reference: &[(f64, f64)]) -> String {
    let captions = LineCaptions {
        title,
        x: "position <x> [m]",
        y: "energy [-]",
        reference: "exact",
        stopped: "stopped",
        shaded: "grows",
    };
    let line = Line {
        label: "linear + <Taylor>".into(),
        family: 7,
        variant: 9,
        points: points.to_vec(),
        stopped: "3 s".into(),
    };
    let panel = LinePanel {
        name: "a & b".into(),
        lines: vec![line.clone(), line],
        reference: reference.to_vec(),
        shaded: points.iter().map(|&(x, y)| [x, x + 1.0, y, y + 1.0]).collect(),
    };
    draw_lines(&captions, axis, &[panel.clone(), panel], 2)
}

const LOG: LineAxis = LineAxis {
    range: (0.1, 10.0),
    log: true,
};
const PLAIN: LineAxis = LineAxis {
    range: (0.0, 2.0),
    log: false,
};

const HARD: [&[(f64, f64)]; 8] = [
    &[],
    &[(0.0, 0.0)],
    &[(1.0, 5.0), (1.0, 5.0)],
    &[(f64::NAN, 1.0), (f64::INFINITY, f64::NEG_INFINITY)],
    &[(1e-320, 1e-320), (0.0, 0.0)],
    &[
        (-1e308, 1e308),
        (1e308, -1e308),
        (1e299, -1e299),
        (-1e299, 1e-299),
    ],
    &[(1.0, 1e9), (1.0 + 1e-15, 1e9 + 1e-6)],
    &[(1e-12, 1e-250), (1e12, 1e250)],
];

#[test]
fn texts_are_there_and_escaped() {
    let data = [(0.0, 1.0), (1.0, 2.0)];
    let pictures = [
        draw_fields("a < b & c", "position <x> [m]", &[panel(&data, &data)]),
        draw_grid_of_fields(
            "a < b & c",
            "position <x> [m]",
            "stress [Pa]",
            &[panel(&data, &data)],
            3,
        ),
        draw_study("a < b & c", "position <x> [m]", "error [-]", &[curve(&data)]),
        lines("a < b & c", LOG, &data, &data),
    ];
    for svg in pictures {
        check(&svg);
        assert!(
            svg.contains("a &lt; b &amp; c") && svg.contains("position &lt;x&gt; [m]"),
            "{svg}"
        );
    }
}

#[test]
fn every_field_draws() {
    for particles in HARD {
        for reference in HARD {
            let panels = [panel(particles, reference), panel(reference, particles)];
            check(&draw_fields("t", "x [m]", &panels));
            check(&draw_grid_of_fields("t", "x [m]", "y [Pa]", &panels, 0));
        }
    }
    check(&draw_fields("", "", &[]));
    check(&draw_grid_of_fields("", "", "", &[], 3));
}

#[test]
fn every_line_draws_and_has_one_entry_in_the_legend() {
    for points in HARD {
        for reference in HARD {
            for axis in [LOG, PLAIN] {
                let svg = lines("t", axis, points, reference);
                check(&svg);
                assert_eq!(svg.matches("linear + &lt;Taylor&gt;").count(), 1);
            }
        }
    }
    let captions = LineCaptions::default();
    assert!(draw_lines(&captions, PLAIN, &[], 3).contains("no data"));
    assert!(draw_lines(&captions, PLAIN, &[LinePanel::default()], 0).contains("no data"));
}

#[test]
fn every_study_draws() {
    for first in HARD {
        for second in HARD {
            check(&draw_study(
                "t",
                "time [s]",
                "error [-]",
                &[curve(first), curve(second)],
            ));
        }
    }
}

#[test]
fn nothing_to_draw_says_so() {
    assert!(draw_study("t", "x", "y", &[]).contains("no data"));
    assert!(draw_study("t", "x", "y", &[curve(&[(0.0, 1.0)])]).contains("no data"));
    assert!(draw_fields("t", "x", &[]).contains("no data"));
    assert!(draw_fields("t", "x", &[panel(&[(0.0, f64::NAN)], &[])]).contains("no data"));
}

#[test]
fn what_cannot_be_drawn_is_counted() {
    let study = draw_study(
        "t",
        "x",
        "y",
        &[curve(&[(1.0, 0.1), (2.0, 0.0), (3.0, f64::NAN)])],
    );
    assert!(study.contains("2 points not drawn"));
    let reference = [(0.0, 0.0), (1.0, 1.0)];
    let grid = draw_grid_of_fields(
        "t",
        "x",
        "y",
        &[panel(&[(0.5, 1e30), (0.6, f64::NAN)], &reference)],
        1,
    );
    assert!(grid.contains("1 outside, 1 not finite"));
}

#[test]
fn a_million_particles_make_a_small_picture() {
    let particles: Vec<(f64, f64)> = (0..1_000_000).map(|i| (f64::from(i) * 1e-6, 1.0)).collect();
    assert!(draw_fields("t", "x [m]", &[panel(&particles, &[])]).len() < 300_000);
    assert!(draw_fields("t", "x [m]", &[panel(&[], &particles)]).len() < 100_000);
}
