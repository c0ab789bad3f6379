#!/usr/bin/env python3
"""Our NMPC solvers beside CasADi's IPOPT, fatrop and acados, on the same instances.

Builds what it needs under target/ (Python packages from PyPI, our solvers with cargo) and leaves table,
figure and all measurements in dist/peers/. Every solver gets every instance in turn, in one run, on one
core; the moves that come back are judged by one simulation of the full model. Times are of single calls, by
each solver's own clock, which leaves out Python (acados: `time_tot`, CasADi: `t_wall_total`). The table shows
the least of the repeats per instance; measurements.json has the single calls too.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
VENV = TARGET / "peers-venv"
ACADOS = TARGET / "peers-acados"
ARMS = ("pendulum", "tflex")


def parse():
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="Classes of instances: golden, random, active (hot), starved (thermal budget of 0.2 to 3 %),\n"
        "over (above the thermal limit by up to 0.2 %), far over (by up to 50 %); see instances.py. Compare\n"
        "figures of one run only: machines and their load differ.",
    )
    parser.add_argument(
        "--instances", type=int, default=40, metavar="N", help="random instances per arm (default 40)"
    )
    parser.add_argument(
        "--special", type=int, metavar="N", help="instances of each other class (default 3/10 of that)"
    )
    parser.add_argument(
        "--full", action="store_true", help="as --instances 200 --special 50: about ten minutes"
    )
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="calls per instance (default 5)")
    parser.add_argument("--arms", nargs="+", choices=ARMS, default=ARMS, help="which arms (default both)")
    parser.add_argument("--seed", type=int, default=1, help="of the instances (default 1)")
    parser.add_argument("--core", type=int, metavar="N", help="core to run on (default the last)")
    parser.add_argument("--no-acados", action="store_true", help="leave acados out")
    parser.add_argument(
        "--store", action="store_true", help="write table and figure to docs/ too, for the README"
    )
    options = parser.parse_args()
    if options.full:
        options.instances, options.special = 200, 50
    if options.special is None:
        options.special = max(1, options.instances * 3 // 10)
    if min(options.instances, options.special, options.repeats) < 1:
        parser.error("counts must be at least 1")
    return options


def prepare(options):
    """Python packages and our binary; goes on in the new environment."""
    python = VENV / "bin" / "python3"
    if not python.exists():
        print(f"Python environment in {VENV} ...", flush=True)
        subprocess.run([sys.executable, "-m", "venv", str(VENV)], check=True)
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "-r", str(HERE / "requirements.txt")], check=True)
    if not options.no_acados and not (ACADOS / "acados").exists():
        requirements = str(HERE / "requirements-acados.txt")
        # A folder of its own and no dependencies: the package brings a CasADi that would replace ours.
        install = subprocess.run(
            [*pip, "--no-deps", "--target", str(ACADOS), "-r", requirements], check=False
        )
        if install.returncode != 0:
            print("acados cannot be installed on this platform; going on without it.", flush=True)
    build = ["cargo", "build", "--release", "--quiet", "-p", "flexarm-benches"]
    subprocess.run(build, cwd=ROOT, env=os.environ | {"CARGO_TARGET_DIR": str(TARGET)}, check=True)
    os.execv(python, [str(python), str(HERE / "run.py"), *sys.argv[1:]])


def versions(server, acados):
    """Versions of every tool, and the machine."""
    from importlib import metadata

    cpu = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        models = [
            line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if "model name" in line
        ]
        cpu = models[0] if models else cpu
    first = subprocess.run(
        ["cc", "--version"], capture_output=True, text=True, check=False
    ).stdout.splitlines()
    found = {
        "cpu": cpu,
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "compiler of the peers' models": first[0] if first else "none",
        "flexarm": server.problem(ARMS[0]).version,
        "casadi (with IPOPT, fatrop)": metadata.version("casadi"),
    }
    if acados:
        folders = ACADOS.glob("comma_deps_acados-*.dist-info")
        found["comma-deps-acados"] = "".join(f.name.removesuffix(".dist-info").split("-")[1] for f in folders)
        headers = ACADOS.glob("acados/**/blasfeo_target.h")
        lines = [line.split() for header in headers for line in header.read_text().splitlines()]
        found["its linear algebra is for"] = next((x[1] for x in lines if x[:1] == ["#define"]), "unknown")
    return found


def compare(options):
    """Measures and reports; runs in the environment that `prepare` made."""
    sys.path.insert(0, str(HERE))
    import measure

    core = measure.pin(options.core)
    import acados_solver
    import figure
    import instances
    import ours
    import report

    acados = False
    if not options.no_acados and (ACADOS / "acados").exists():
        try:
            acados_solver.load(ACADOS)
            acados = True
        except (OSError, ImportError) as error:
            print(f"acados does not run on this platform: {error}")
    counts = {kind: options.special for kind in instances.CLASSES if kind != "golden"}
    counts["random"] = options.instances
    folders = {"build": TARGET / "peers-build", "golden": ROOT / "control" / "tests" / "golden"}
    server = ours.Server(TARGET / "release" / "flexarm-benches")
    environment = versions(server, acados) | {"core": core, "repeats": options.repeats, "seed": options.seed}
    records = []
    for arm in options.arms:
        found, absent = measure.run(server, arm, counts, options, folders, acados)
        records += found
        for name, why in absent.items():
            print(f"{name} takes no part on the {arm}: {why}")
    server.close()

    note = f"{environment['cpu']}; all classes, best of {options.repeats} calls, by each solver's own clock"
    head = "\n".join(f"{key}: {value}" for key, value in environment.items())
    times = f"{report.LEGEND}\n{report.aligned(report.table(records))}"
    checks = f"{report.ACCURACY}\n{report.aligned(report.accuracy(records))}"
    together = f"{report.INSTANCES}\n{report.aligned(report.by_instance(records))}"
    text = f"{head}\n\n{times}\n\n{together}\n\n{checks}\n"
    print(text)
    noted = [abs(r["optimum_to_noted"]) for r in records if "optimum_to_noted" in r]
    print(f"Golden instances: IPOPT's optimum here and as noted differ by at most {max(noted):.1e}.")

    out = ROOT / "dist" / "peers"
    out.mkdir(parents=True, exist_ok=True)
    (out / "table.txt").write_text(text)
    results = {"environment": environment, "summary": report.summary(records), "records": records}
    (out / "measurements.json").write_text(json.dumps(results))
    figure.draw(records, out / "peers.svg", note)
    print(f"Table, figure and measurements: {out}")
    if options.store:
        store(text, out)


def store(text, out):
    """The small results for the README."""
    docs = ROOT / "docs"
    (docs / "peers.txt").write_text(text)
    (docs / "peers.svg").write_bytes((out / "peers.svg").read_bytes())
    print(f"Stored: {docs / 'peers.txt'}, {docs / 'peers.svg'}")


if __name__ == "__main__":
    chosen = parse()
    if Path(sys.prefix).resolve() == VENV.resolve():
        compare(chosen)
    else:
        prepare(chosen)
