"""tree_copy.py: a copy of the tree in which tests change something, build it and run it."""
import os
import shutil
import subprocess


def run(command, where):
    """What a shell command in a folder ends with and prints; 124 when it runs without end."""
    os.environ.pop("CMOCKA_MESSAGE_OUTPUT", None)  # run.sh asks for TAP: the words looked for are cmocka's own
    try:
        return subprocess.run(command, shell=True, cwd=where, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", timeout=300)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, 124, "runs without end", "")


def copy_tree(where):
    """Tracked files and what is built of them, with their times: the copy builds only what is changed then."""
    shutil.rmtree(where, ignore_errors=True)
    for name in subprocess.check_output(["git", "ls-files"], text=True).split("\n"):
        if name and os.path.exists(name):
            os.makedirs(os.path.dirname(os.path.join(where, name)), exist_ok=True)
            shutil.copy2(name, os.path.join(where, name))
    os.makedirs(where + "/build")
    for part in ("obj", "lib", ".deps"):
        if os.path.exists("build/" + part):
            run("cp -a %s %s" % (os.path.abspath("build/" + part), os.path.abspath(where + "/build/")), ".")
