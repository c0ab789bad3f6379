//! The tables of a run.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use control::nmpc::problem::Initial;
use serde_json::json;

use super::{Group, Options, Record};
use crate::Failure;
use crate::machine;
use crate::output::write_whole;
use crate::statistics::{Durations, aligned, text};

/// Unsolved starts that are printed per group at most.
const SHOWN: usize = 5;
/// One sample at 4 kHz: a plan above this cannot be made in every sample.
const LATE: Duration = Duration::from_micros(250);
/// First numbers of iterations of the histogram's rows; a row ends where the next begins.
const ROWS: [u32; 25] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 18, 20, 25, 30, 40, 50, 60, 100,
];

/// Prints all tables.
///
/// # Errors
/// How many plans are unsolved, if any are.
pub fn print(options: &Options, groups: &[Group]) -> Result<(), Failure> {
    let Options {
        count,
        seed,
        repeats,
        solver,
        ..
    } = options;
    println!("{}", machine());
    println!(
        "{count} starts of each class and arm, seed {seed}, {repeats} calls each, by {solver}\n"
    );
    println!("{}\n", aligned(&times(groups, *repeats), &[0, 1, 2, 12]));
    println!("Plans by iterations (0: in closed form)\n");
    for of_arm in groups.chunk_by(|a, b| a.arm == b.arm) {
        println!("{}\n", aligned(&histogram(of_arm), &[0]));
    }
    println!("The slowest of each class, for `flexarm-benches serve`\n");
    for group in groups {
        if let Some(slowest) = group.records.iter().max_by_key(|record| record.best) {
            println!("{}", described(group, slowest, solver));
        }
    }
    if let Some(path) = &options.save {
        save(path, groups, solver)?;
    }
    let unsolved = groups.iter().flat_map(|group| {
        let unsolved = group.records.iter().filter(|r| !r.is_solved());
        unsolved.take(SHOWN).map(move |record| (group, record))
    });
    let records = || groups.iter().flat_map(|group| &group.records);
    let (plans, failed) = (
        records().count(),
        records().filter(|r| !r.is_solved()).count(),
    );
    let worst = records().map(|r| r.best).max().unwrap_or_default();
    println!(
        "\n{plans} plans, {failed} unsolved; the slowest takes {}",
        text(worst)
    );
    if failed == 0 {
        return Ok(());
    }
    println!("\nUnsolved, the first {SHOWN} of each class\n");
    for (group, record) in unsolved {
        println!("{}", described(group, record, solver));
    }
    Err(format!("{failed} of {plans} plans are unsolved").into())
}

/// Writes all that is unsolved or late.
fn save(path: &Path, groups: &[Group], solver: &str) -> Result<(), Failure> {
    let mut lines = String::new();
    for group in groups {
        let bad = |record: &&Record| !record.is_solved() || record.best > LATE;
        for record in group.records.iter().filter(bad) {
            lines += &described(group, record, solver);
            lines.push('\n');
        }
    }
    write_whole(path, &lines)
}

/// Statuses and times of each group.
fn times(groups: &[Group], repeats: u32) -> Vec<Vec<String>> {
    let best = format!("least of {repeats}");
    let late = format!("> {} us", LATE.as_micros());
    let heads = [
        ["arm", ""],
        ["class", ""],
        ["start", ""],
        [&best, "median"],
        ["", "p99"],
        ["", "max"],
        ["", &late],
        ["single calls", "median"],
        ["", "p99"],
        ["", "p99.9"],
        ["", "max"],
        ["unsolved", ""],
        ["statuses", ""],
    ];
    let mut rows: Vec<Vec<String>> = [0, 1]
        .map(|line| heads.map(|head| head[line].to_owned()).to_vec())
        .to_vec();
    for group in groups {
        let best = Durations::new(group.records.iter().map(|record| record.best).collect());
        let calls = Durations::new(group.calls.clone());
        let mut row = vec![
            group.arm.clone(),
            group.class.to_owned(),
            group.knowledge.to_owned(),
        ];
        row.extend([0.5, 0.99, 1.0].map(|share| text(best.quantile(share))));
        let late = group.records.iter().filter(|r| r.best > LATE).count();
        row.push(late.to_string());
        row.extend([0.5, 0.99, 0.999, 1.0].map(|share| text(calls.quantile(share))));
        let unsolved = group.records.iter().filter(|r| !r.is_solved()).count();
        row.push(unsolved.to_string());
        let mut statuses = BTreeMap::new();
        for record in &group.records {
            let (_, count) = statuses
                .entry(record.status as i32)
                .or_insert((record.status, 0));
            *count += 1;
        }
        let statuses: Vec<_> = statuses
            .values()
            .map(|(status, count)| format!("{count} {status:?}"))
            .collect();
        row.push(statuses.join(", "));
        rows.push(row);
    }
    rows
}

/// Plans by iterations: a column for each group.
fn histogram(groups: &[Group]) -> Vec<Vec<String>> {
    let head = |of: fn(&Group) -> &str| groups.iter().map(move |group| of(group).to_owned());
    let mut rows: Vec<Vec<String>> = vec![
        [String::new()]
            .into_iter()
            .chain(head(|g| &g.arm))
            .collect(),
        [String::new()]
            .into_iter()
            .chain(head(|g| g.class))
            .collect(),
        ["iterations".to_owned()]
            .into_iter()
            .chain(head(|g| g.knowledge))
            .collect(),
    ];
    for (index, &first) in ROWS.iter().enumerate() {
        let end = ROWS.get(index + 1).copied().unwrap_or(u32::MAX);
        let of = |group: &Group| {
            let inside = |record: &&Record| (first..end).contains(&record.iterations);
            group.records.iter().filter(inside).count()
        };
        let counts: Vec<_> = groups.iter().map(of).collect();
        if counts.iter().all(|&count| count == 0) {
            continue;
        }
        let mut row = vec![match end {
            u32::MAX => format!("{first} or more"),
            end if end == first + 1 => first.to_string(),
            end => format!("{first}..{}", end - 1),
        }];
        row.extend(counts.iter().map(|count| match count {
            0 => String::new(),
            count => count.to_string(),
        }));
        rows.push(row);
    }
    let mean = |group: &Group| {
        let iterated = group
            .records
            .iter()
            .map(|r| r.iterations)
            .filter(|&n| n > 0);
        let (count, sum) = iterated.fold((0_u32, 0), |(count, sum), n| (count + 1, sum + n));
        match count {
            0 => String::new(),
            count => format!("{:.1}", f64::from(sum) / f64::from(count)),
        }
    };
    let mut row = vec!["mean of those > 0".to_owned()];
    row.extend(groups.iter().map(mean));
    rows.push(row);
    rows
}

/// A plan, and the requests that repeat it.
fn described(group: &Group, record: &Record, solver: &str) -> String {
    let request = |initial: &Initial, goal: f64, warm: bool| {
        let state = [
            initial.angle,
            initial.velocity,
            initial.reference_angle,
            initial.reference_velocity,
            initial.integral,
            initial.thermal_load,
        ];
        let request = json!({
            "arm": group.arm, "solver": solver, "initial": state, "goal": goal, "warm": warm, "repeats": 5,
        });
        format!("\n  {request}")
    };
    let converged = match (record.converged, record.widened) {
        (false, _) => ", not converged",
        (true, true) => ", beyond the angle bounds",
        (true, false) => "",
    };
    let mut lines = format!(
        "{}, {}, {}: {:?}{converged}, {} iterations, {}",
        group.arm,
        group.class,
        group.knowledge,
        record.status,
        record.iterations,
        text(record.best)
    );
    let before = record.before.as_ref();
    lines.extend(before.map(|(initial, goal)| request(initial, *goal, false)));
    lines + &request(&record.initial, record.goal, before.is_some())
}

#[cfg(test)]
mod tests {
    use control::nmpc::plan::PlanStatus;

    use super::*;

    fn group(iterations: &[u32]) -> Group {
        let record = |&iterations| Record {
            before: None,
            initial: Initial::default(),
            goal: 0.0,
            status: PlanStatus::ThermalSlack,
            iterations,
            converged: iterations < 60,
            widened: false,
            best: Duration::from_micros(10 * u64::from(iterations)),
        };
        Group {
            arm: "arm".to_owned(),
            class: "class",
            knowledge: "cold",
            records: iterations.iter().map(record).collect(),
            calls: vec![Duration::ZERO],
        }
    }

    #[test]
    fn every_plan_is_in_one_row_of_the_histogram() {
        let rows = histogram(&[group(&[0, 0, 17, 60, 150]), group(&[2])]);
        let expected = [
            ["0", "2", ""],
            ["2", "", "1"],
            ["16..17", "1", ""],
            ["60..99", "1", ""],
            ["100 or more", "1", ""],
            ["mean of those > 0", "75.7", "2.0"],
        ];
        assert_eq!(rows[3..], expected);
    }

    #[test]
    fn unfinished_plans_are_unsolved_and_late_ones_are_counted() {
        let rows = times(&[group(&[0, 26, 60])], 4);
        assert_eq!((rows[2][6].as_str(), rows[2][11].as_str()), ("2", "1"));
        assert_eq!(rows[2][12], "3 ThermalSlack");
    }
}
