"""What tests share that compare files of scene_file_tool with other programs: each is called with the path of
scene_file_tool and of a folder for its files.
"""
import json
import subprocess
import sys

tool, folder = sys.argv[1:]
failures = 0


def check(holds, what):
    global failures
    print("ok:" if holds else "FAILED:", what)
    failures += not holds


def near(a, b, tolerance=1e-5):
    """Whether two nestings of numbers agree. 1e-5: some roundings of numbers of size 10 in single precision."""
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return abs(a - b) <= tolerance
    return len(a) == len(b) > 0 and all(near(x, y, tolerance) for x, y in zip(a, b))


def run(*arguments):
    return subprocess.run([tool, *arguments], capture_output=True, text=True)


def read(path):
    """What scene_file_tool finds in a file."""
    done = run("print", path)
    if done.returncode:
        sys.exit(f"{path}: {done.stderr}")
    return json.loads(done.stdout)


def finish():
    sys.exit(failures > 0)
