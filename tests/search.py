"""Random call sequences against the C interfaces of a packaged FMU.

    python tests/search.py dist/fmi3/FlexArmController.fmu --count 100000 --seed 1

A sequence instantiates, makes some forty calls, legal and illegal, with values in and out of range, and
frees. Whatever comes, the FMU must not crash, hang, leak or poison itself, must refuse what the standard
forbids for a reason (status Error and a message), accept what it demands, and never put out anything but
numbers. A failure names its seed; `--seed N --count 1` repeats it.
"""

import argparse
import multiprocessing
import resource
import sys
from pathlib import Path

from abi import Fmu
from called import Failed
from calls import Sequence

# Seconds that a sequence may take; one takes milliseconds.
PATIENCE = 60


def work(path: str, seeds: range, at, failures) -> None:
    """Run the sequences of some seeds; `at` tells how far they are should the process die."""
    fmu = Fmu(Path(path))
    settled = 0
    for n, seed in enumerate(seeds):
        at.value = seed
        try:
            Sequence(fmu, seed).run()
        except Failed as failure:
            failures.put(f"seed {seed}: {failure}")
            return
        used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        if n == len(seeds) // 4:
            settled = used
        elif settled and used > settled + 20_000:
            failures.put(f"seed {seed}: {used - settled} kB more than after a quarter of the sequences")
            return
    at.value = -1


def run(path: Path, first: int, count: int, progress=None) -> list[str]:
    """Run sequences in a process of their own, which may crash or hang; the failures."""
    context = multiprocessing.get_context("spawn")
    at, failures = context.Value("q", first), context.Queue()
    worker = context.Process(target=work, args=(str(path), range(first, first + count), at, failures))
    worker.start()
    seen = None
    while worker.is_alive():
        worker.join(PATIENCE)
        if worker.is_alive() and at.value == seen:
            worker.kill()
            return [f"seed {seen}: no end after {PATIENCE} s"]
        seen = at.value
        if progress and seen >= 0:
            progress(seen - first)
    found = []
    while not failures.empty():
        found.append(failures.get())
    if not found and at.value != -1:
        found.append(f"seed {at.value}: the process ended with {worker.exitcode}")
    return found


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("fmu", type=Path, nargs="+")
    parser.add_argument("--count", type=int, default=10_000, help="sequences for each FMU")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first")
    arguments = parser.parse_args()
    failures = []
    for path in arguments.fmu:
        found = run(
            path,
            arguments.seed,
            arguments.count,
            lambda done, path=path: print(f"{path}: {done} of {arguments.count}", file=sys.stderr),
        )
        print(f"{path}: {arguments.count} sequences, {found or 'nothing found'}")
        failures += found
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
