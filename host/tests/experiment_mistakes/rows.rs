//! Mistakes in expectations and figures.

use super::Mistake;

pub const MISTAKES: &[Mistake] = &[
    (
        "max_abs(plant.y)",
        "maxabs(plant.y)",
        "e.toml:18: expect.quantity: \"maxabs(plant.y)\" is no quantity",
    ),
    (
        "max_abs(plant.y)",
        "max_abs(plant.x)",
        "e.toml:18: expect.quantity: no column plant.x is recorded",
    ),
    (
        "max_abs(plant.y)",
        "plans.done",
        "e.toml:18: expect.quantity: plans have no status \"done\"",
    ),
    (
        "[\"a, strong\"]",
        "[\"a\"]",
        "e.toml:19: expect.of: there is no run \"a\"; there are: \"a, weak\", \"a, strong\"",
    ),
    (
        "of = [\"a, strong\"]",
        "",
        "e.toml:17: expect.name: there is no run \"ratio\"",
    ),
    (
        "[\"a, strong\"]",
        "[]",
        "e.toml:19: expect.of: names no run",
    ),
    (
        "paper = 4",
        "tolerance = 1",
        "e.toml:20: expect.tolerance: needs the figure that it is about",
    ),
    (
        "paper = 4",
        "paper = 0\npaper_tolerance = 1",
        "e.toml:21: expect.paper_tolerance: nothing but 0 deviates from 0",
    ),
    (
        "paper = 4",
        "paper = 4\ntolerance = -1",
        "e.toml:21: expect.tolerance = -1: expected a relative deviation, 0 or more",
    ),
    (
        "paper = 4",
        "paper = inf",
        "e.toml:20: expect.paper = inf: expected a finite number",
    ),
    (
        "paper = 4",
        "factor = 0",
        "e.toml:20: expect.factor = 0: expected a finite number that is not 0",
    ),
    (
        "paper = 4",
        "at_least = 2\nat_most = 1",
        "e.toml:21: expect.at_most = 1: expected at least at_least = 2",
    ),
    (
        "name = \"1\"",
        "name = \"1/2\"",
        "e.toml:22: figure.name: the name of a figure names its file",
    ),
    (
        "title = \"F\"",
        "title = \"F\"\nfrom = 2\nuntil = 1",
        "e.toml:25: figure.until = 1: expected more than from = 2",
    ),
    (
        "title = \"F\"",
        "title = \"F\"\nkind = \"frequency_response\"\nfrom = 0",
        "e.toml:25: figure.from = 0: expected a positive frequency in Hz",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.z\"",
        "e.toml:27: figure.panel.curves.y: no column plant.z is recorded, did you mean plant.y?",
    ),
    (
        "- controller.y\"",
        "- controller.z\", factor = 2",
        "e.toml:28: figure.panel.curves.y: no column controller.z is recorded",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.y\", x = \"tme\"",
        "e.toml:27: figure.panel.curves.x: no column tme is recorded, did you mean time?",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.y\", factor = nan",
        "e.toml:27: figure.panel.curves.factor = NaN: expected a finite number that is not 0",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.y\", style = \"dots\"",
        "e.toml:27: figure.panel.curves.style: unknown variant `dots`",
    ),
    (
        "run = \"a, strong\"",
        "run = \"b\"",
        "e.toml:28: figure.panel.curves.run: there is no run \"b\"",
    ),
];
