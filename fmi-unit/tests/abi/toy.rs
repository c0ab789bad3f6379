//! The unit under test: a lag x' = (u − x)/τ whose input is sampled by a clock, with ways to fail.

mod variables;

pub use variables::*;

use fmi_unit::{Failure, Log, Severity, Ticks, Unit};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;

thread_local! {
    /// What happens on this thread while the partition of `slow` works.
    pub static WORK: RefCell<Option<Box<dyn FnMut()>>> = const { RefCell::new(None) };
}

/// u times each weight.
fn ramp(u: f64, weight: &[f64], ramp: &mut [f64]) {
    for (value, weight) in ramp.iter_mut().zip(weight) {
        *value = u * weight;
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ToyState {
    x: f64,
    ticks: u64,
    sampled: f64,
    samples: i32,
    behaviour: i64,
}

pub struct Toy {
    start: f64,
    period: f64,
    tau: f64,
    gain: [f64; 3],
    state: ToyState,
}

impl Toy {
    fn derivative(&self, u: f64) -> f64 {
        (u - self.state.x) / self.tau
    }
}

impl Drop for Toy {
    fn drop(&mut self) {
        if self.state.behaviour == PANIC_IN_DROP && !std::thread::panicking() {
            panic!("told to panic in drop");
        }
    }
}

impl Unit for Toy {
    type Variables = ToyVariables;
    type State = ToyState;
    type Job = f64;

    fn initial_outputs(v: &mut ToyVariables) {
        v.x = v.bias;
        v.der_x = (v.u - v.bias) / v.tau;
        v.twice = 2.0 * v.u;
        ramp(v.u, &v.weight, &mut v.ramp);
    }

    fn new(v: &mut ToyVariables, start: f64) -> Result<Self, Vec<Failure>> {
        if v.behaviour == PANIC_IN_NEW {
            panic!("told to panic in new");
        }
        let mut failures = Vec::new();
        if v.gain[0] > v.gain[1] + 9.0 {
            failures.push(Failure("gain[1] is too large".into()));
        }
        if v.seed == 13 {
            failures.push(Failure("seed = 13 is unlucky".into()));
        }
        if !failures.is_empty() {
            return Err(failures);
        }
        Ok(Self {
            start,
            period: v.period,
            tau: v.tau,
            gain: v.gain,
            state: ToyState {
                x: v.bias,
                ticks: 0,
                sampled: 0.0,
                samples: 0,
                behaviour: v.behaviour,
            },
        })
    }

    fn state(&self) -> &ToyState {
        &self.state
    }

    fn is_admissible(state: &ToyState) -> bool {
        state.x.is_finite()
    }

    fn set_state(&mut self, state: &ToyState) -> Result<(), Failure> {
        self.state.clone_from(state);
        Ok(())
    }

    fn next_event(&self) -> f64 {
        self.start + self.state.ticks as f64 * self.period
    }

    fn event(&mut self, v: &mut ToyVariables, time: f64, log: &mut Log<'_>) -> Result<(), Failure> {
        self.state.behaviour = v.behaviour;
        match v.behaviour {
            FAIL_IN_EVENT => return Err(Failure(format!("told to fail at {time} s"))),
            PANIC_IN_EVENT => panic!("told to panic at {time} s, 100%s\0!"),
            STUCK => return Ok(()),
            _ => {}
        }
        if time < self.next_event() - 1e-6 {
            // A step event: fold x back.
            self.state.x -= self.gain[1];
            return Ok(());
        }
        self.state.ticks += 1;
        self.state.x += self.gain[0];
        if !v.hold {
            self.state.sampled = v.u;
            self.state.samples = self.state.samples.saturating_add(1);
        }
        if v.u.is_nan() {
            let message = format_args!("u is not a number at {time} s");
            log.write(Severity::Warning, "logStatusWarning", message);
        }
        if v.u == f64::NEG_INFINITY {
            log.write(Severity::Info, "undeclared", format_args!("{time} s"));
        }
        log.write(
            Severity::Info,
            "logEvents",
            format_args!("sample at {time} s"),
        );
        Ok(())
    }

    /// `fast` samples every `period`, `slow` ten times less often.
    fn clock_interval(v: &ToyVariables, clock: usize) -> f64 {
        v.period * [1.0, 10.0][clock]
    }

    fn set_clock_interval(v: &mut ToyVariables, clock: usize, interval: f64) {
        v.period = interval / [1.0, 10.0][clock];
    }

    /// `slow` jumps before `fast` samples.
    fn tick(
        &mut self,
        v: &mut ToyVariables,
        ticks: Ticks,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<(), Failure> {
        if ticks.contains(1) {
            self.state.x += self.gain[0];
        }
        if ticks.contains(0) {
            self.activate(v, 0, time, log)?;
        }
        Ok(())
    }

    /// `fast` samples at once; `slow` looks at u, works, and sets x.
    fn activate(
        &mut self,
        v: &mut ToyVariables,
        clock: usize,
        time: f64,
        _: &mut Log<'_>,
    ) -> Result<Option<f64>, Failure> {
        if v.behaviour == FAIL_IN_EVENT {
            return Err(Failure(format!("told to fail at {time} s")));
        }
        if clock == 1 {
            return Ok(Some(v.u));
        }
        self.state.sampled = v.u;
        self.state.samples += 1;
        Ok(None)
    }

    fn work(job: &mut f64) {
        WORK.with_borrow_mut(|work| {
            if let Some(work) = work {
                work();
            }
        });
        *job *= 2.0;
    }

    fn complete(&mut self, _: &mut ToyVariables, job: f64, _: &mut Log<'_>) -> Result<(), Failure> {
        self.state.x = job;
        Ok(())
    }

    fn advance(
        &mut self,
        v: &mut ToyVariables,
        from: f64,
        to: f64,
        _: &mut Log<'_>,
    ) -> Result<(), Failure> {
        if v.behaviour == FAIL_IN_ADVANCE {
            return Err(Failure(format!("told to fail at {from} s")));
        }
        let decay = (-(to - from) / self.tau).exp();
        self.state.x = v.u + (self.state.x - v.u) * decay;
        Ok(())
    }

    fn outputs(&self, v: &mut ToyVariables) {
        if v.behaviour == PANIC_IN_OUTPUTS {
            panic!("told to panic in outputs");
        }
        v.x = self.state.x;
        v.der_x = self.derivative(v.u);
        v.samples = self.state.samples;
        v.sampled = self.state.sampled;
        v.twice = 2.0 * v.u;
        ramp(v.u, &v.weight, &mut v.ramp);
    }

    fn continuous_states(&self, states: &mut [f64]) {
        states[0] = self.state.x;
    }

    fn set_continuous_states(&mut self, states: &[f64]) {
        self.state.x = states[0];
    }

    fn derivatives(&self, v: &ToyVariables, derivatives: &mut [f64]) {
        derivatives[0] = self.derivative(v.u);
    }

    fn tangent(&self, v: &ToyVariables, direction: &ToyVariables, tangent: &mut ToyVariables) {
        tangent.x = direction.x;
        tangent.der_x = (direction.u - direction.x) / self.tau;
        tangent.twice = 2.0 * direction.u;
        ramp(direction.u, &v.weight, &mut tangent.ramp);
    }

    fn completed_step(&mut self, _: &ToyVariables, _: f64) -> bool {
        self.gain[1] > 0.0 && self.state.x > self.gain[1]
    }
}
