"""The command of the module is the program."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import springfit as sf


def program(*arguments, **options):
    # The folder of the package, where it is not installed.
    environment = {**os.environ, "PYTHONPATH": str(Path(sf.__file__).resolve().parents[1])}
    return subprocess.run([sys.executable, "-m", "springfit", *arguments], capture_output=True, text=True, env=environment, **options)


def test_the_module_is_the_program(tmp_path, scenes):
    assert program("--version").stdout.split() == ["springfit", sf.__version__]
    done = program("run", str(scenes / "square_quad.toml"), "--out", "out", cwd=tmp_path)
    assert done.returncode == 0 and (tmp_path / "out" / "report.json").exists(), done.stderr
    assert "exact" in program("fit", "--help").stdout


@pytest.mark.parametrize(
    "arguments, code, words",
    [
        (["run", "missing.toml"], 2, "missing.toml"),
        (["rnu"], 2, "rnu"),
        (["check", "broken.toml"], 2, "broken.toml"),
    ],
)
def test_codes_are_those_of_the_program(arguments, code, words, tmp_path):
    done = program(*arguments, cwd=tmp_path)
    assert done.returncode == code and words in done.stderr and "Traceback" not in done.stderr


def test_the_command_is_in_files_as_it_was_typed(tmp_path):
    mesh = tmp_path / "square.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    done = program("fit", "square.obj", "--young", "1e4", "--poisson", "0.3", "--thickness", "1 mm", "-o", "a.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert 'springfit fit square.obj --young 1e4' in (tmp_path / "a.json").read_text()


@pytest.mark.skipif(os.name != "posix", reason="not run: signals are those of POSIX")
def test_interrupts_end_the_program(scenes, tmp_path):
    command = [sys.executable, "-m", "springfit", "sweep", str(scenes / "square_quad.toml"), "--set", "sweep.over={material.poisson={from=0.0,to=0.4,count=100000}}", "--out", "o"]
    # A program that a shell has started in the background ignores interrupts, and so would its children.
    heard = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=heard)
    # A signal that comes while Python starts is not one to the program.
    log, end = tmp_path / "o" / "studies.jsonl", time.monotonic() + 60
    while not (log.exists() and log.stat().st_size) and time.monotonic() < end:
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) in (130, -signal.SIGINT, 1, 0)
    process.stdout.close(), process.stderr.close()
