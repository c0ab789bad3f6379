//! Where rows and variables are, and the patterns of P and A.

use clarabel::algebra::CscMatrix;

use super::super::super::spline::stencil;
use super::super::super::transcription::Transcription;
use super::super::pattern::Entries;
use super::super::safe_rows::SafeRows;
use super::super::torque_rows;
use super::{CONE, Convex};

impl Convex {
    /// First row of the slacks' signs.
    pub(super) fn slack_row(&self) -> usize {
        2 * self.bounds
    }

    /// First row of the loads' room.
    pub(super) fn room_row(&self) -> usize {
        self.slack_row() + self.loads
    }

    /// Row of the room of the last load.
    pub(super) fn last_room_row(&self) -> usize {
        self.room_row() + self.horizon - 1
    }

    /// First row of the torque limit.
    pub(super) fn torque_row(&self) -> usize {
        self.room_row() + self.loads
    }

    /// First linear row of the safe sets.
    pub(super) fn safe_row(&self) -> usize {
        self.torque_row() + self.torque_rows
    }

    /// First row of the cone of interval `k`.
    pub(super) fn cone_row(&self, k: usize) -> usize {
        let safe = self.safe.map_or(0, |_| SafeRows::LINEAR);
        self.safe_row() + safe + CONE * k
    }

    /// The variable of the torque's slack.
    pub(super) fn torque_slack(&self) -> usize {
        self.free + 2 * self.loads
    }

    /// One, or none without a torque limit.
    pub(super) fn torque_slacks(&self) -> usize {
        self.torque_rows.min(1)
    }

    pub(super) fn variables(&self) -> usize {
        let safe = self.safe.as_ref().map_or(0, SafeRows::variables);
        self.torque_slack() + self.torque_slacks() + safe
    }

    pub(super) fn pattern_p(&self) -> CscMatrix<f64> {
        let (mut starts, mut rows) = (vec![0], Vec::new());
        let variables = self.variables();
        for column in 0..variables {
            if column < self.free {
                rows.extend(column.saturating_sub(self.band)..=column);
            }
            starts.push(rows.len());
        }
        let values = vec![0.0; rows.len()];
        CscMatrix::new(variables, variables, starts, rows, values)
    }

    /// A with its constant entries; those of currents and safe sets are zero until posed.
    pub(super) fn pattern_a(&self, transcription: &Transcription) -> CscMatrix<f64> {
        let mut entries = Entries::default();
        for m in 0..self.free {
            // c of node m + 1 moves this node and the next.
            for (node, weight) in [
                (m, stencil(transcription, m + 1)[0][1]),
                (m + 1, stencil(transcription, m + 2)[0][0]),
            ] {
                if node < self.bounds {
                    entries.add(node, m, weight);
                    entries.add(self.bounds + node, m, -weight);
                }
            }
            for k in (m..m + 3).take_while(|&k| k < self.loads) {
                for row in 2..CONE {
                    entries.add(self.cone_row(k) + row, m, 0.0);
                }
            }
        }
        for k in 0..self.loads {
            let (load, cone) = (self.free + k, self.cone_row(k));
            entries.add(self.room_row() + k, load, 1.0);
            entries.add(cone, load, -1.0);
            entries.add(cone + 1, load, -1.0);
            if k + 1 < self.horizon {
                let next = self.cone_row(k + 1);
                let decay = transcription.interval(k + 1).thermal.decay();
                entries.add(next, load, decay);
                entries.add(next + 1, load, decay);
            }
            let slack = self.free + self.loads + k;
            entries.add(self.slack_row() + k, slack, -1.0);
            entries.add(self.room_row() + k, slack, -1.0);
        }
        if let Some(limit) = &transcription.problem().torque_limit {
            torque_rows::add(
                transcription,
                limit,
                self.torque_row(),
                [self.free, self.torque_slack()],
                &mut entries,
            );
        }
        let mut rows = self.cone_row(self.loads);
        if let Some(safe) = &self.safe {
            safe.add(self.last_room_row(), &mut entries);
            rows += safe.cone_rows();
        }
        entries.matrix(rows, self.variables())
    }
}
