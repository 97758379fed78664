use super::super::{read, sentence, table};
use super::*;
use nlmodes::modal::ContactPeriod;
use nlmodes_scene::scene::Overlay;
use std::fs;

/// A branch of frequency `10 + a` Hz over amplitudes 0 to 2 in units of `unit`, that turns back at 12 Hz.
fn laid(text: &str) -> Laid {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    fs::write(&path, text).unwrap();
    read(&Overlay { path, label: "test".into() }).unwrap()
}

#[test]
fn levels_that_had_not_settled_and_responses_to_loads_are_no_points_of_a_mode() {
    let test = laid(
        "record,frequency_hz,modal_amplitude,findings\na,10.3,0.5,\nb,11.0,1.0,aperiodic \
            skew\nc,11.2,1.5,too-few-modes\n",
    );
    let label = &test.branch.label;
    assert_eq!((test.branch.points.len(), label.as_str()), (2, "test, without 1 that had not settled"));
    let test = laid("frequency_hz,modal_amplitude,findings\n10.3,0.5,not-locked\n");
    assert_eq!((test.branch.points.len(), test.branch.label.as_str()), (1, "test, not settled"));
    let responses =
        "frequency_hz,energy_j,kind,response,curve\n10,1,frequency,1,1\n10,2,damped-mode,2,1\n11,3,mode,3,1\n";
    assert_eq!(laid(responses).branch.points.len(), 1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("branch.csv");
    fs::write(&path, "frequency_hz,energy_j,kind,response,curve\n10,1,frequency,1,1\n").unwrap();
    let error = read(&Overlay { path, label: "test".into() }).unwrap_err();
    assert!(error.to_string().contains("holds responses to loads, and no mode"), "{error}");
}

#[test]
fn a_softer_test_is_called_so_with_its_difference_in_any_unit() {
    for unit in [1.0, 1e-6] {
        let own =
            laid(&format!("frequency_hz,modal_amplitude\n10.0,{:e}\n11.0,{:e}\n12.0,{:e}\n", 0.0, unit, 2.0 * unit));
        let test = laid(&format!(
            "record,frequency_hz,modal_amplitude,peak_contact_force_n\n\
             a,10.29,{:e},5\nb,,,\nc,99,{:e},\nd,11.27,{:e},7\n",
            0.5 * unit,
            9.0 * unit,
            1.5 * unit
        ));
        let found = differences(&test, &own.branch);
        assert_eq!(found.iter().map(|d| d.point).collect::<Vec<_>>(), [0, 2], "rows without values are no points");
        for (difference, wanted) in found.iter().zip([10.5, 11.5]) {
            assert!((difference.own_frequency - wanted).abs() < 1e-12, "{difference:?}");
            assert!((difference.relative() + 0.02).abs() < 1e-12);
        }
        assert_eq!(found[1].force, 7.0);
        let table = table(&test, &found);
        let columns = ["point", "amplitude, m√kg", "frequency, Hz", "this branch, Hz", "frequency off by, %"];
        assert_eq!(table.head[..5], columns.map(String::from), "nothing is known of energies and impulses");
        assert_eq!((table.head.len(), table.rows[1][5].as_str()), (8, "7.0000e0"));
        let said = sentence(&test, &found, &own.branch);
        assert!(said.contains("softer than test") && said.contains("−2.00 %"), "{said}");
    }
}

#[test]
fn impulses_are_compared_where_both_are_known() {
    let contact = |impulse: f64| ContactPeriod { impulse, ..ContactPeriod::default() };
    let table = "frequency_hz,modal_amplitude,peak_contact_force_n\n10,1,100\n11,2,300\n12,3,500\n";
    let (mut own, mut other) = (laid(table), laid("frequency_hz,modal_amplitude,peak_contact_force_n\n11.5,2.5,800\n"));
    assert!(differences(&other, &own.branch)[0].impulse.is_nan());
    for (k, point) in own.branch.points.iter_mut().enumerate() {
        point.contacts = vec![contact(k as f64), contact(2.0 * k as f64)];
    }
    other.branch.points[0].contacts = vec![contact(1.5), contact(3.6)];
    let found = differences(&other, &own.branch);
    // Half-way between 3 and 6 N s, and between 300 and 500 N.
    assert!((found[0].impulse - 5.1).abs() < 1e-12 && (found[0].own_impulse - 4.5).abs() < 1e-12);
    let said = sentence(&other, &found, &own.branch);
    assert!(said.contains("impulse a period by +13.3 %") && said.contains("largest force by +100 %"), "{said}");
}

#[test]
fn at_equal_frequency_the_motion_with_the_nearest_amplitude_counts_and_several_are_said() {
    let contact = |impulse: f64| ContactPeriod { impulse, ..ContactPeriod::default() };
    // Both stiffen; the first turns at 14 Hz and comes back.
    let mut own = laid("frequency_hz,modal_amplitude\n10,1\n12,2\n14,3\n13,4\n");
    let mut other = laid("frequency_hz,modal_amplitude\n10,1\n11,2\n12.5,3\n13.5,3.4\n");
    for (k, point) in own.branch.points.iter_mut().enumerate() {
        point.contacts = vec![contact(k as f64), contact(10.0)];
    }
    other.branch.points.iter_mut().for_each(|point| point.contacts = vec![contact(3.0), contact(10.0)]);
    other.is_scattered = false;
    let found = at_equal_frequency(&other, &own.branch);
    assert_eq!(found.iter().map(|d| d.motions).collect::<Vec<_>>(), [1, 1, 1, 2]);
    assert!(found.iter().all(|d| d.equal == Equal::Frequency && d.relative().abs() < 1e-12 && d.amplitude.is_nan()));
    // Half-way from the first to the second point, a quarter behind the second; at 13.5 Hz amplitude 3.5 is nearer to
    // 3.4 than 2.75 is.
    for (difference, impulse) in found[1..].iter().zip([0.5, 1.25, 2.5]) {
        assert!((difference.stops[0][1] - impulse).abs() < 1e-12 && difference.stops[1] == [10.0; 2], "{difference:?}");
        assert!((difference.own_impulse - impulse - 10.0).abs() < 1e-12);
    }
    // For a test it is unknown which of several motions at a frequency was measured.
    other.is_scattered = true;
    assert_eq!(at_equal_frequency(&other, &own.branch)[3].motions, 2);
}

#[test]
fn points_without_contact_are_in_no_mean_of_impulses_and_forces() {
    let contact = |impulse: f64| ContactPeriod { impulse, ..ContactPeriod::default() };
    let table = "frequency_hz,modal_amplitude,peak_contact_force_n\n10,1,0\n11,2,0\n12,3,0\n13,4,100\n14,5,300\n";
    let (mut own, mut other) = (laid(table), laid(table));
    for (laid, share) in [(&mut own, 1.0), (&mut other, 2.0)] {
        laid.is_scattered = false;
        for point in &mut laid.branch.points {
            point.contacts = vec![contact(share * point.peak_contact_force)];
            point.peak_contact_force *= share;
        }
    }
    let said = sentence(&other, &differences(&other, &own.branch), &own.branch);
    assert!(said.contains("impulse a period by +100 % at 2 points, those that touch a stop in both; "), "{said}");
    assert!(said.contains("largest force by +100 % at 2 points") && said.contains("by 0 % at 5 points"), "{said}");
}

#[test]
fn partners_at_a_tongue_are_in_no_mean() {
    // Both go up, back and up again over amplitudes 2 to 3, as at an internal resonance; beyond, one has another
    // internal resonance.
    let own = laid("frequency_hz,modal_amplitude\n10,1\n13,3\n12,2\n14,4\n18,8\n");
    let mut other =
        laid("frequency_hz,modal_amplitude\n10.2,1\n11.22,1.9\n13.2,3\n12.1,2\n14.2,4\n17.1,7\n16.1,6\n18.2,8\n");
    other.is_scattered = false;
    let found = differences(&other, &own.branch);
    assert_eq!(found.iter().map(|d| d.motions).collect::<Vec<_>>(), [1, 1, 2, 2, 1, 2, 2, 1]);
    let said = sentence(&other, &found, &own.branch);
    assert!(said.contains("at 4 points; ") && said.contains("4 points are left out"), "{said}");
    // Points of a test are no curve: what counts is how many motions the branch has.
    other.is_scattered = true;
    let found = differences(&other, &own.branch);
    assert_eq!(found.iter().map(|d| d.motions).collect::<Vec<_>>(), [1, 1, 1, 2, 1, 1, 1, 1]);
    assert!(found.iter().all(Difference::is_clear));
    // From grazing to the first turn both correspond, wherever internal resonances lead; beyond it only one motion
    // does.
    other.is_scattered = false;
    let mut own = own;
    for graze in [&mut own.branch, &mut other.branch] {
        graze.points[0].events.push(Event::Grazing);
    }
    let found = differences(&other, &own.branch);
    assert_eq!(found.iter().map(|d| d.motions).collect::<Vec<_>>(), [1, 1, 1, 2, 1, 2, 2, 1]);
    assert!((found[2].own_frequency - 13.0).abs() < 1e-12, "{:?}", found[2]);
    let turned = |laid: &Laid| {
        let mut turned = laid.clone();
        turned.branch.points.reverse();
        turned
    };
    let counts = differences(&turned(&other), &turned(&own).branch).iter().map(|d| d.motions).collect::<Vec<_>>();
    assert_eq!(counts, [1, 2, 2, 1, 2, 1, 1, 1]);
}

#[test]
fn of_several_motions_a_test_has_the_one_that_fits_its_other_points() {
    // The branch has three motions at amplitude 2.5: 12, 13 and 14 Hz.
    let own = laid("frequency_hz,modal_amplitude\n10,1\n11,2\n13,3\n13,2\n15,3\n20,8\n");
    // Softer by 8 % throughout: 0.92 · 14 Hz lies nearer to 13 Hz, 0.92 · 13 Hz to 12 Hz.
    for hz in [12.0, 13.0, 14.0] {
        let table = format!(
            "frequency_hz,modal_amplitude\n{},1\n{},1.5\n{},6\n{},7\n{},2.5\n",
            0.92 * 10.0,
            0.92 * 10.5,
            0.92 * 18.0,
            0.92 * 19.0,
            0.92 * hz
        );
        let test = laid(&table);
        let found = differences(&test, &own.branch);
        let last = &found[4];
        assert!(last.is_matched && last.motions == 3 && (last.own_frequency - hz).abs() < 1e-12, "{hz}: {last:?}");
        assert!(found[..4].iter().all(|difference| !difference.is_matched && difference.is_clear()));
        let said = sentence(&test, &found, &own.branch);
        assert!(
            said.contains("softer than test;") && said.contains("by −8.00 % at 5 points, of which 1 with"),
            "{said}"
        );
    }
    // Without any point with a unique motion nothing can be decided.
    let test = laid("frequency_hz,modal_amplitude\n12.9,2.5\n");
    let found = differences(&test, &own.branch);
    assert!(!found[0].is_clear() && found[0].motions == 3);
    assert!(sentence(&test, &found, &own.branch).contains("nothing to compare"));
}

#[test]
fn a_tongue_that_is_left_out_at_one_frequency_does_not_end_the_way_from_grazing() {
    let mut own = laid("frequency_hz,modal_amplitude\n10,1\n11,2\n11,2.2\n13,4\n");
    let mut other = laid("frequency_hz,modal_amplitude\n10,1\n12,3\n12.5,3.5\n");
    own.branch.points[2].events.push(Event::Resumed);
    for branch in [&mut own.branch, &mut other.branch] {
        branch.points[0].events.push(Event::Grazing);
    }
    other.is_scattered = false;
    assert!(at_equal_frequency(&other, &own.branch).iter().all(Difference::is_clear));
    // The same for a branch that ends at grazing, where the event is also after the internal resonance.
    let mut back = own.clone();
    back.branch.points.reverse();
    back.branch.points[2].events.push(Event::Resumed);
    back.branch.points[1].events.clear();
    assert!(at_equal_frequency(&other, &back.branch).iter().all(Difference::is_clear));
    // Where the branch continues at a lower frequency, some are passed twice.
    own.branch.points[2].omega *= 0.9;
    assert!(!at_equal_frequency(&other, &own.branch).iter().all(Difference::is_clear));
}

#[test]
fn where_nothing_lies_within_the_branch_both_ranges_are_said() {
    for (size, unit) in [("modal_amplitude", "m√kg"), ("energy_j", "J")] {
        let own = laid(&format!("frequency_hz,{size}\n10,5e-4\n12,2e-3\n"));
        let test = laid(&format!("frequency_hz,{size}\n10,2.0\n11,0.5\n12,\n"));
        let said = sentence(&test, &differences(&test, &own.branch), &own.branch);
        let ranges = format!(" are 5.000e-1 to 2.000e0 {unit}, those of test 5.000e-4 to 2.000e-3 {unit}");
        assert!(said.contains("no point to compare with test: its ") && said.ends_with(&ranges), "{said}");
    }
}

#[test]
fn tables_that_hold_no_points_say_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    for (text, wanted) in [
        ("a,b\n1,2\n", "no column frequency_hz"),
        ("frequency_hz,level\n1,2\n", "no column modal_amplitude or energy_j"),
        ("frequency_hz,energy_j\n,\n", "no row with a frequency"),
    ] {
        fs::write(&path, text).unwrap();
        let error = read(&Overlay { path: path.clone(), label: String::new() }).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    let error = read(&Overlay { path: folder.path().join("none.csv"), label: String::new() }).unwrap_err();
    assert!(crate::chain(&error).contains("none.csv"), "{error}");
    let error = read(&Overlay { path: folder.path().to_path_buf(), label: String::new() }).unwrap_err().to_string();
    assert!(error.contains("neither branch.csv nor modal_points.csv"), "{error}");
}
