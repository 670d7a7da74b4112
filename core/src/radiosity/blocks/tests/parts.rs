//! Parts that do not fit together.

use super::*;

fn made(settings: &Settings<'_>) -> Parts {
    encode(&part(21), &albedo(21, 0.5), settings).into_parts()
}

fn refused(parts: &Parts, change: impl FnOnce(&mut Parts)) -> BlockError {
    let mut parts = parts.clone();
    change(&mut parts);
    BlockOperator::from_parts(parts).unwrap_err()
}

#[test]
fn good_ones_make_the_operator_again() {
    for settings in [Settings::published(3), Settings::mended(), Settings::bounced(4)] {
        let operator = encode(&part(21), &albedo(21, 0.5), &settings);
        assert_eq!(BlockOperator::from_parts(operator.parts().clone()), Ok(operator));
    }
    let nothing = Parts {
        matrix: Matrix::Gather,
        format: Format::Bc1,
        half: false,
        order: Vec::new(),
        albedo: Vec::new(),
        scales: Vec::new(),
        values: vec![0.0; 256],
        blocks: Vec::new(),
        starts: vec![0],
        entries: Entries::Full { columns: Vec::new(), values: Vec::new() },
    };
    let operator = BlockOperator::from_parts(nothing).unwrap();
    assert!(operator.is_empty() && run(&operator, &[], &[]).is_empty());
}

#[test]
fn wrong_ones_are_refused() {
    use BlockError as E;
    let full = made(&Settings::published(3));
    let short = made(&Settings::bounced(4));
    let long = |slice: &'static str| move |e: E| matches!(e, E::WrongLength { slice: s, .. } if s == slice);
    assert!(long("values")(refused(&full, |p| p.values.truncate(255))));
    assert!(long("blocks")(refused(&full, |p| p.blocks.truncate(3))));
    assert!(long("starts")(refused(&full, |p| p.starts.truncate(3))));
    assert!(long("order")(refused(&full, |p| p.order.truncate(3))));
    assert!(long("scales")(refused(&short, |p| p.scales.truncate(3))));
    assert!(
        long("blocks")(refused(&full, |p| p.albedo.truncate(3)))
            || matches!(refused(&full, |p| p.albedo.truncate(3)), E::WrongLength { .. })
    );
    assert!(matches!(refused(&full, |p| p.albedo = vec![[0.5; 3]; PATCHES_MAX + 1]), E::TooLarge { .. }));
    assert!(matches!(refused(&full, |p| p.values[0] = 1.0), E::BadValue { slice: "value", index: 0, .. }));
    assert!(matches!(refused(&full, |p| p.values[9] = f32::NAN), E::BadValue { index: 9, .. }));
    assert!(matches!(refused(&full, |p| p.values[9] = -1.0), E::BadValue { index: 9, .. }));
    assert!(matches!(
        refused(&full, |p| p.albedo[4][1] = 1.5),
        E::BadValue { slice: "albedo", index: 4, .. }
    ));
    assert!(matches!(
        refused(&short, |p| p.scales[4][1] = 0.0),
        E::BadValue { slice: "scale", index: 4, .. }
    ));
    assert!(matches!(refused(&full, |p| p.order[1] = p.order[0]), E::NoPermutation { row: 1, .. }));
    assert!(matches!(refused(&full, |p| p.order[2] = 21), E::NoPermutation { row: 2, patch: 21 }));
    assert!(matches!(refused(&full, |p| p.matrix = Matrix::Bounces(0)), E::NoBounces));
    assert!(matches!(refused(&full, |p| p.format = Format::Bc4), E::WrongFormat { .. }));
    assert!(matches!(refused(&full, |p| p.half = true), E::NotSymmetric { .. }));
    assert!(matches!(refused(&full, |p| p.starts[0] = 1), E::BadRow { row: 0 }));
    assert!(matches!(refused(&full, |p| p.starts[5] = u32::MAX), E::BadRow { row: 4 }));
    assert!(matches!(refused(&full, |p| p.starts[21] += 1), E::BadRow { row: 21 }));
    let values = |change: fn(&mut Vec<f32>)| {
        refused(&full, |p| match &mut p.entries {
            Entries::Full { values, .. } => change(values),
            Entries::Short { .. } => unreachable!(),
        })
    };
    assert!(long("kept values")(values(|v| v.truncate(1))));
    assert!(matches!(values(|v| v[4] = f32::INFINITY), E::BadValue { slice: "kept value", index: 1, .. }));
    let shorts = |change: fn(&mut Vec<u16>, &mut Vec<u16>, &mut f32)| {
        refused(&short, |p| match &mut p.entries {
            Entries::Short { columns, values, unit } => change(columns, values, unit),
            Entries::Full { .. } => unreachable!(),
        })
    };
    assert!(matches!(shorts(|_, v, _| v[1] = 0x7c00), E::BadValue { slice: "kept value", index: 1, .. }));
    assert!(matches!(shorts(|_, _, u| *u = 1e9), E::BadValue { slice: "unit", .. }));
    assert!(matches!(shorts(|_, _, u| *u = f32::NAN), E::BadValue { slice: "unit", .. }));
    // A column beyond the row's half.
    assert!(matches!(shorts(|c, _, _| c.iter_mut().for_each(|c| *c = 20)), E::BadRow { .. }));
}

#[test]
fn wrong_light_is_refused() {
    let operator = encode(&part(9), &albedo(9, 0.5), &Settings::mended());
    let (direct, mut room) = (lit(9), Workspace::default());
    let mut indirect = vec![[0.0; 3]; 9];
    let mut run = |direct: &[[f32; 3]], emission: &[[f32; 3]]| {
        operator.relight(&Portable, (direct, emission), &mut indirect, &mut room)
    };
    assert!(matches!(run(&direct[1..], &[]), Err(BlockError::WrongLength { .. })));
    assert!(matches!(run(&direct, &direct[1..]), Err(BlockError::WrongLength { .. })));
    assert!(matches!(run(&[[f32::NAN; 3]; 9], &[]), Err(BlockError::BadValue { .. })));
    assert_eq!(run(&direct, &direct), Ok(()));
}
