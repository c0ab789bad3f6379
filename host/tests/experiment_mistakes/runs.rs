//! Mistakes in what runs.

use super::Mistake;

pub const MISTAKES: &[Mistake] = &[
    ("title = \"T\"\n", "", "e.toml:1: missing field `title`"),
    (
        "until = 3",
        "until = ",
        "e.toml:6: common.until: string values must be quoted",
    ),
    (
        "until = 3",
        "until = 3\nuntil = 4",
        "e.toml:7: common.until: duplicate key",
    ),
    (
        "until = 3",
        "untill = 3",
        "e.toml:6: common.untill: unknown field `untill`",
    ),
    (
        "until = 3",
        "until = true",
        "e.toml:6: common.until: invalid type: boolean `true`",
    ),
    (
        "until = 3",
        "until = -1",
        "e.toml:6: common.until = -1: expected a time in [0.5, 5e8] s",
    ),
    (
        "step = 0.5",
        "step = 0",
        "e.toml:7: common.step = 0: expected a positive time in s",
    ),
    (
        "step = 0.5",
        "record = 0",
        "e.toml:7: common.record = 0: expected at least 1",
    ),
    (
        "until = 3\nstep = 0.5",
        "until = 1e5\nstep = 1e-4",
        "e.toml:15: run \"a, weak\": record = 1000000000 rows of 6 values: expected at most 536870912",
    ),
    (
        "step = 0.5",
        "order = \"both\"",
        "e.toml:7: common.order: unknown variant `both`",
    ),
    (
        "c.fmu",
        "x.fmu",
        "e.toml:3: common.controller: x.fmu cannot be read: ",
    ),
    (
        "p.fmu",
        "m.toml",
        "e.toml:4: common.plant: m.toml is not an FMU",
    ),
    (
        "plant = \"p.fmu\"\n",
        "",
        "e.toml:13: run: the run has no plant: name its FMU",
    ),
    (
        "m.toml",
        "x.toml",
        "e.toml:5: common.connections: cannot read x.toml: ",
    ),
    (
        "connections = \"m.toml\"\n",
        "",
        "e.toml:14: run \"a, weak\": no output of one FMU has the name of an input",
    ),
    (
        "m.toml",
        "from.toml",
        "from.toml:2: connection.from: plant has no variable z",
    ),
    (
        "m.toml",
        "factor.toml",
        "factor.toml:5: connection.factor = 0: expected a finite number that is not 0",
    ),
    (
        "step = 0.5",
        "parameters = [\n\"right.ssv\",\n\"x.ssv\"]",
        "e.toml:9: common.parameters: cannot read x.ssv: ",
    ),
    (
        "step = 0.5",
        "parameters = [\"unit.ssv\"]",
        "unit.ssv:4: u is given in mm, but its unit is rad",
    ),
    (
        "step = 0.5",
        "setpoints = \"x.csv\"",
        "e.toml:7: common.setpoints: cannot read x.csv: ",
    ),
    (
        "step = 0.5",
        "setpoints = \"bytes.csv\"",
        "e.toml:7: common.setpoints: bytes.csv is not text in UTF-8",
    ),
    (
        "step = 0.5",
        "setpoints = \"push.csv\"",
        "push.csv:1: neither FMU has a variable push",
    ),
    (
        "step = 0.5",
        "setpoints = \"right.csv\"",
        "e.toml:7: common.setpoints: right.csv: the setpoint is connected to no input",
    ),
    (
        "step = 0.5",
        "sequence = { every = 1, setpoints = [1] }",
        "e.toml:7: common.sequence: the setpoint is connected to no input",
    ),
    (
        "step = 0.5",
        "sequence = { every = 0, setpoints = [1] }",
        "e.toml:7: common.sequence.every = 0: expected a positive time in s",
    ),
    (
        "step = 0.5",
        "sequence = { every = 1, setpoints = [1,\n nan] }",
        "e.toml:8: common.sequence.setpoints: setpoint = \"NaN\": expected a finite number",
    ),
    (
        "step = 0.5",
        "schedule = { columns = [\"time\", \"setpoint\"], rows = [[0, 1],\n [1]] }",
        "e.toml:8: common.schedule.rows: 1 values, but the header names 2 columns",
    ),
    (
        "step = 0.5",
        "schedule = { columns = [\"time\", \"setpoint\", \"push\"], rows = [[0, 1, 2]] }",
        "e.toml:7: common.schedule.columns: neither FMU has a variable push",
    ),
    (
        "step = 0.5",
        "schedule = { columns = [\"time\", \"setpoint\"], rows = [[0, \"x\"]] }",
        "e.toml:7: common.schedule.rows: invalid type: string \"x\"",
    ),
    (
        "step = 0.5",
        "setpoints = \"a.csv\"\nsequence = { every = 1, setpoints = [1] }",
        "e.toml:2: common: only one of setpoints, schedule and sequence",
    ),
    (
        "gain = 2",
        "gian = 2",
        "e.toml:9: common.set: neither FMU has a variable gian, did you mean gain?",
    ),
    (
        "gain = 2",
        "\"plant:gian\" = 2",
        "e.toml:9: common.set: plant has no variable gian, did you mean gain?",
    ),
    (
        "gain = 2",
        "gain = 11",
        "e.toml:9: common.set: gain = 11: must be in [-10, 10]",
    ),
    (
        "gain = 2",
        "gain = nan",
        "e.toml:9: common.set: gain = \"NaN\": expected a finite number",
    ),
    (
        "gain = 2",
        "gain = 1979-05-27",
        "e.toml:9: common.set: gain: expected a number",
    ),
    (
        "gain = 2",
        "vector = 1",
        "e.toml:9: common.set: vector is an array: use its elements vector[1] to vector[3]",
    ),
    (
        "gain = 2",
        "flag = true",
        "e.toml:9: common.set: plant.flag is an output that cannot be set",
    ),
    (
        "step = 0.5",
        "name = \"x\"",
        "e.toml:7: common.name: name belongs to runs and variants",
    ),
    (
        "name = \"weak\"",
        "",
        "e.toml:10: variant: missing field `name`",
    ),
    (
        "name = \"strong\"",
        "name = \"weak\"",
        "e.toml:15: run \"a, weak\": \"a-weak\" is the name of another run",
    ),
    (
        "name = \"a\"",
        "name = \"\"",
        "e.toml:15: run.name: \"\" names no folder",
    ),
];
