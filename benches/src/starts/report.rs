//! The tables of a run.

use std::collections::BTreeMap;

use control::nmpc::problem::Initial;
use serde_json::json;

use super::{Group, Options, Record, is_solved};
use crate::Failure;
use crate::machine;
use crate::statistics::{Durations, aligned, text};

/// Unsolved starts that are printed per group at most.
const SHOWN: usize = 5;
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
    println!("{}\n", aligned(&times(groups, *repeats), &[0, 1, 2, 10]));
    println!("Iterations: number of plans (0: in closed form)\n");
    println!("{}\n", aligned(&histogram(groups), &[0]));
    println!("The slowest of each class, for `flexarm-benches serve`\n");
    for group in groups {
        let slowest = group.records.iter().max_by_key(|record| record.best);
        slowest
            .into_iter()
            .for_each(|slowest| show(group, slowest, solver));
    }
    let unsolved: Vec<_> = groups
        .iter()
        .map(|group| group.records.iter().filter(|r| !is_solved(r.status)))
        .map(Iterator::collect::<Vec<_>>)
        .collect();
    let total: usize = unsolved.iter().map(Vec::len).sum();
    let worst = groups.iter().flat_map(|g| &g.records).map(|r| r.best).max();
    let plans: usize = groups.iter().map(|group| group.records.len()).sum();
    println!(
        "\n{plans} plans, {total} unsolved; the slowest takes {}",
        text(worst.unwrap_or_default())
    );
    if total == 0 {
        return Ok(());
    }
    println!("\nUnsolved, the first {SHOWN} of each class\n");
    for (group, unsolved) in groups.iter().zip(unsolved) {
        unsolved
            .iter()
            .take(SHOWN)
            .for_each(|record| show(group, record, solver));
    }
    Err(format!("{total} of {plans} plans are unsolved").into())
}

/// Statuses and times of each group.
fn times(groups: &[Group], repeats: u32) -> Vec<Vec<String>> {
    let best = format!("least of {repeats}");
    let mut rows = vec![
        [
            "arm",
            "class",
            "start",
            &best,
            "",
            "",
            "single calls",
            "",
            "",
            "",
            "statuses",
        ]
        .map(str::to_owned)
        .to_vec(),
        [
            "", "", "", "median", "p99", "max", "median", "p99", "p99.9", "max", "",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    for group in groups {
        let best = Durations::new(group.records.iter().map(|record| record.best).collect());
        let calls = Durations::new(group.calls.clone());
        let mut row = vec![
            group.arm.clone(),
            group.class.to_owned(),
            start(group).to_owned(),
        ];
        row.extend([0.5, 0.99, 1.0].map(|share| text(best.quantile(share))));
        row.extend([0.5, 0.99, 0.999, 1.0].map(|share| text(calls.quantile(share))));
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

fn start(group: &Group) -> &'static str {
    if group.warm { "warm" } else { "cold" }
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
            .chain(head(start))
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
fn show(group: &Group, record: &Record, solver: &str) {
    println!(
        "{}, {}, {}: {:?}, {} iterations, {}",
        group.arm,
        group.class,
        start(group),
        record.status,
        record.iterations,
        text(record.best)
    );
    let request = |initial: &Initial, warm: bool| {
        let state = [
            initial.angle,
            initial.velocity,
            initial.reference_angle,
            initial.reference_velocity,
            initial.integral,
            initial.thermal_load,
        ];
        json!({
            "arm": group.arm, "solver": solver, "initial": state, "goal": record.goal, "warm": warm, "repeats": 5,
        })
    };
    if let Some(before) = &record.before {
        println!("  {}", request(before, false));
    }
    println!("  {}", request(&record.initial, group.warm));
}
