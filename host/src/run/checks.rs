//! What a run is refused for, or warned of, before its first step.

use super::{DEFAULT_STEP, Simulation};
use crate::fmu::short;
use crate::input::connections::{Source, Wiring};
use crate::input::parameters::StartValues;
use crate::input::roles::Role;
use crate::input::setpoints::Table;
use crate::input::{Error, Pair, Side};
use std::ops::RangeInclusive;

/// Communication steps of a run. They are counted in f64, exact up to 2⁵³; 10⁹ of 0.25 ms are three days.
pub(crate) const STEPS: RangeInclusive<f64> = 1.0..=1e9;

/// A number that cannot be meant.
pub(crate) fn setting(name: impl Into<String>, value: f64, expected: String) -> Error {
    Error::Setting {
        name: name.into(),
        value: short(value),
        expected,
    }
}

/// Refuses communication points that no run has: the time between them \[s\], and every which is recorded.
pub(crate) fn points(step: f64, record_every: usize) -> Result<(), Error> {
    if !(step.is_finite() && step > 0.0) {
        return Err(setting("--step", step, "a positive time in s".to_owned()));
    }
    if record_every == 0 {
        return Err(setting("--record", 0.0, "at least 1".to_owned()));
    }
    Ok(())
}

/// Number of whole communication steps in a time \[s\]; none if it is beyond [`STEPS`].
pub(crate) fn whole_steps(duration: f64, step: f64) -> Option<usize> {
    let steps = (duration / step + 1e-6).floor();
    STEPS.contains(&steps).then_some(steps as usize)
}

/// Says that a run ends before the time that was asked for, as no whole number of steps reaches it.
pub(crate) fn cut(origin: &str, until: f64, end: f64, step: f64) -> Option<String> {
    (until - end > 1e-3 * step).then(|| {
        let (until, end, step) = (short(until), short(end), short(step));
        format!(
            "{origin} {until} s is no whole number of steps of {step} s: the run ends at {end} s"
        )
    })
}

/// Number of whole communication steps of the run.
pub(super) fn steps(
    simulation: &Simulation,
    pair: Pair<'_>,
    table: Option<&Table>,
) -> Result<usize, Error> {
    let step = simulation.step;
    points(step, simulation.record_every)?;
    let stop = |side| pair.of(side).default_experiment.stop_time;
    let (until, origin) = if let Some(until) = simulation.until {
        (until, "--until".to_owned())
    } else if let Some(duration) = table.and_then(Table::duration) {
        let place = simulation.setpoints_place();
        (duration, format!("{place}: end of the setpoints"))
    } else if let Some(time) = stop(Side::Plant) {
        (time, "plant: default stop time".to_owned())
    } else if let Some(time) = stop(Side::Controller) {
        (time, "controller: default stop time".to_owned())
    } else {
        (1.0, "end of the run".to_owned())
    };
    if let Some(steps) = whole_steps(until, step) {
        return Ok(steps);
    }
    let (fewest, most) = (*STEPS.start(), *STEPS.end());
    // The end is to blame, unless it would do with an ordinary step.
    Err(if whole_steps(until, DEFAULT_STEP).is_some() {
        let (low, high) = (short(until / most), short(until / fewest));
        let expected = format!("a time in [{low}, {high}] s for a run of {until} s");
        setting("--step", step, expected)
    } else {
        let (low, high) = (short(fewest * step), short(most * step));
        let expected = format!(
            "a time in [{low}, {high}] s with steps of {} s",
            short(step)
        );
        setting(origin, until, expected)
    })
}

/// Setpoints that nothing follows, or whose outcome nothing shows, are a mistake in the names or an exchange
/// of the two FMUs.
pub(super) fn setpoint_and_angle(
    simulation: &Simulation,
    pair: Pair<'_>,
    wiring: &Wiring,
) -> Result<(), Error> {
    let Some(missing) = missing(wiring) else {
        return Ok(());
    };
    if simulation.setpoints.is_none() {
        return Ok(());
    }
    Err(Error::Purposeless {
        file: simulation.setpoints_place().to_string(),
        missing,
        swapped: swapped(pair),
    })
}

/// What keeps setpoints from having a meaning.
fn missing(wiring: &Wiring) -> Option<&'static str> {
    let connected = |c: &crate::input::connections::Connection| c.tap.source == Source::Setpoint;
    if !wiring.connections.iter().any(connected) {
        Some("the setpoint is connected to no input")
    } else if !wiring.roles.contains_key(&Role::Angle) {
        Some("no signal plays the role of the angle")
    } else {
        None
    }
}

/// Whether the names fit together if each FMU takes the place of the other.
fn swapped(pair: Pair<'_>) -> bool {
    let other = Pair {
        controller: pair.plant,
        plant: pair.controller,
    };
    let fits = |pair| Wiring::read(pair, None).is_ok_and(|w| missing(&w).is_none());
    !fits(pair) && fits(other)
}

/// The same without setpoints, where it may be meant.
pub(super) fn wiring(pair: Pair<'_>, wiring: &Wiring) -> Option<String> {
    let missing = missing(wiring)?;
    let hint = if swapped(pair) {
        ": are controller and plant exchanged?"
    } else {
        ""
    };
    Some(format!("{missing}{hint}"))
}

/// Values given to inputs that something else drives.
pub(super) fn replaced(pair: Pair<'_>, values: &StartValues, wiring: &Wiring) -> Vec<String> {
    let of = |side| {
        let given = values.of(side).into_iter();
        given.filter_map(move |(input, value)| {
            let source = match wiring.source(side, input)? {
                Source::Setpoint => "the setpoint (--setpoints)".to_owned(),
                Source::Output(from, output) => pair.name(from, output),
            };
            let name = pair.name(side, input);
            Some(format!(
                "{name} = {value} is not used: it is connected to {source}"
            ))
        })
    };
    Side::BOTH.into_iter().flat_map(of).collect()
}

/// What the FMUs say of themselves that does not fit.
pub(super) fn descriptions(pair: Pair<'_>, step: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    for side in Side::BOTH {
        let description = pair.of(side);
        if !description.problems.is_empty() {
            warnings.push(format!(
                "{side}: modelDescription.xml has {} problems (flexarm inspect lists them)",
                description.problems.len()
            ));
        }
        let fixed = description.co_simulation.as_ref().and_then(|c| {
            c.fixed_internal_step
                .filter(|_| !c.can_handle_variable_step)
        });
        if let Some(fixed) = fixed
            && ((step / fixed).round() < 1.0
                || (step / fixed - (step / fixed).round()).abs() > 1e-6)
        {
            warnings.push(format!(
                "{side} steps by {fixed} s: {step} s is no multiple of it"
            ));
        }
    }
    warnings
}

/// Periods of the controller that the communication step is too coarse for.
pub(super) fn periods(pair: Pair<'_>, values: &StartValues, step: f64) -> Vec<String> {
    let consequences = [
        (
            "sample_period",
            "several samples see the same angle, and the torque of the last one holds for the whole step",
        ),
        (
            "nmpc.period",
            "plans and iterations are counted once a step, so some are missed",
        ),
    ];
    let coarse = consequences.into_iter().filter_map(|(name, consequence)| {
        let period = values.number(pair, Side::Controller, name)?;
        (step > period * (1.0 + 1e-6)).then(|| {
            format!("--step = {step} s is longer than the controller's {name} = {period} s: {consequence}")
        })
    });
    coarse.collect()
}

/// Refuses recordings that would not fit in memory.
pub(crate) fn size(rows: usize, columns: usize) -> Result<(), Error> {
    const LIMIT: usize = 1 << 29;
    if rows.saturating_mul(columns) <= LIMIT {
        return Ok(());
    }
    Err(Error::Setting {
        name: "--record".to_owned(),
        value: format!("{rows} rows of {columns} values"),
        expected: format!("at most {LIMIT} values: record every n-th communication point"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::parameters::ParameterSets;
    use crate::input::setpoints::{Row, Setpoints};
    use crate::input::tests::contract;

    fn simulation(setpoints: bool) -> Simulation {
        let mut simulation = Simulation::new("c.fmu", "p.fmu");
        simulation.setpoints = setpoints.then(|| Setpoints::File("s.csv".into()));
        simulation
    }

    #[test]
    fn who_makes_a_run_too_long_is_blamed() {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let rows = |times: &[f64]| Table {
            inputs: Vec::new(),
            rows: times
                .iter()
                .map(|&time| Row {
                    time,
                    values: vec![1.0],
                })
                .collect(),
        };
        let outcome = |until, step, table: Option<&Table>| {
            let mut simulation = simulation(table.is_some());
            (simulation.until, simulation.step) = (until, step);
            steps(&simulation, pair, table).map_err(|e| e.to_string())
        };
        assert_eq!(outcome(None, DEFAULT_STEP, None), Ok(80_000));
        assert_eq!(outcome(Some(0.5), 1.0 / 60.0, None), Ok(30));
        assert_eq!(cut("--until", 0.5, 30.0 / 60.0, 1.0 / 60.0), None);
        let cut = cut("--until", 0.1, 0.098, 0.007).unwrap();
        assert!(
            cut.contains("--until 0.1 s") && cut.ends_with("ends at 0.098 s"),
            "{cut}"
        );
        let short = rows(&[0.0, 0.5, 0.500_01]);
        assert_eq!(outcome(None, DEFAULT_STEP, Some(&short)), Ok(4000));
        for (until, step, times, message) in [
            (
                Some(-1.0),
                DEFAULT_STEP,
                None,
                "--until = -1: expected a time in [2.5e-4, 2.5e5] s",
            ),
            (
                Some(f64::NAN),
                DEFAULT_STEP,
                None,
                "--until = NaN: expected a time in",
            ),
            (
                Some(1e300),
                DEFAULT_STEP,
                None,
                "--until = 1e300: expected a time in",
            ),
            (
                Some(1.0),
                1e-12,
                None,
                "--step = 1e-12: expected a time in [1e-9, 1] s for a run of 1 s",
            ),
            (
                Some(1.0),
                2.0,
                None,
                "--step = 2: expected a time in [1e-9, 1] s",
            ),
            (
                Some(1.0),
                -2.0,
                None,
                "--step = -2: expected a positive time in s",
            ),
            (
                None,
                DEFAULT_STEP,
                Some(vec![0.0, 1e300]),
                "s.csv: end of the setpoints = 2e300: expected a time in [2.5e-4, 2.5e5] s",
            ),
            (
                None,
                DEFAULT_STEP,
                Some(vec![0.0, 1e-5]),
                "s.csv: end of the setpoints = 2e-5: ",
            ),
        ] {
            let table = times.map(|times| rows(&times));
            let found = outcome(until, step, table.as_ref()).unwrap_err();
            assert!(found.starts_with(message), "{found}");
        }
    }

    #[test]
    fn exchanged_fmus_are_recognised() {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let right = Pair {
            controller: &controller,
            plant: &plant,
        };
        let wrong = Pair {
            controller: &plant,
            plant: &controller,
        };
        let check = |pair, setpoints| {
            let wired = Wiring::read(pair, None).unwrap();
            let warning = wiring(pair, &wired);
            let outcome = setpoint_and_angle(&simulation(setpoints), pair, &wired);
            (outcome.map_err(|e| e.to_string()), warning)
        };
        assert_eq!(check(right, true), (Ok(()), None));
        let hint = "the setpoint is connected to no input: are controller and plant exchanged?";
        let (outcome, warning) = check(wrong, false);
        assert_eq!((outcome, warning.as_deref()), (Ok(()), Some(hint)));
        let refusal = check(wrong, true).0.unwrap_err();
        assert_eq!(refusal, format!("s.csv: {hint}"));
    }

    #[test]
    fn steps_beyond_the_periods_are_noticed() {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let sets = ["sample_period=0.0005".parse().unwrap()];
        let values = StartValues::new(pair, &ParameterSets::read(&[]).unwrap(), &sets).unwrap();
        assert!(periods(pair, &values, 0.0005).is_empty());
        let coarse = periods(pair, &values, 0.001);
        assert_eq!(coarse.len(), 1);
        assert!(
            coarse[0].starts_with(
                "--step = 0.001 s is longer than the controller's sample_period = 0.0005 s"
            ),
            "{}",
            coarse[0]
        );
        assert_eq!(periods(pair, &values, 0.1).len(), 2);
    }
}
