"""For scripts/slurm: the recipes that make would run, what each waits for, and arrays of them.

Each recipe runs below a make of its own: variables that a target hands down to what it needs do not reach that. (With
make alone they do where that target happens to be the first that asks.)
"""
import os
import re
import shlex
import subprocess
from collections import defaultdict

# Exit statuses, as in lib/base.
USAGE, BAD_DATA, NO_DEVICE, CANNOT_CREATE, INPUT_OUTPUT, TRY_AGAIN = 64, 65, 69, 73, 74, 75


class Failure(Exception):
    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


class File:
    """A name that make knows: what it needs, and the place of its recipe ('' without one)."""

    def __init__(self, name):
        self.name, self.normal, self.order_only, self.also = name, [], [], []
        self.recipe, self.stem = "", ""


class Job:
    """One run of a recipe: the names that it makes, and the jobs that have to end before it."""

    def __init__(self, names, file):
        self.names, self.file = names, file
        self.needs, self.newer = {}, set()  # job by id; ids of those that are reached by normal prerequisites alone
        self.depth, self.index, self.array = None, None, None


def read_files(text):
    """The files of make's data base (make -p), by name."""
    files = {}
    for block in text.split("\n\n"):
        # Variables of the target alone, the target with what it needs, what make knows of it, its recipe.
        lines = block.strip("\n").splitlines()
        start = next((i for i, line in enumerate(lines) if line.startswith("#  ")), 0)
        if start == 0 or "# Not a target:" in lines[:start]:
            continue
        head, about = lines[start - 1], []
        for line in lines[start:]:
            about.append(line)
            if line.startswith("#  recipe to execute ("):
                break
        found = re.match(r"((?:\\.|[^:\\])+)::?(?: |$)(.*)", head)
        if not found or not any(line.startswith("#  Implicit rule search has ") for line in about):
            continue
        name = re.sub(r"\\(.)", r"\1", found[1])
        file = files.setdefault(name, File(name))
        normal, _, order_only = (" " + found[2] + " ").partition(" | ")
        file.normal += normal.split()
        file.order_only += order_only.split()
        for line in about:
            if line.startswith("#  recipe to execute ("):
                place = re.search(r"\((?:from '(.*)', line (\d+)|.*)\):$", line)
                file.recipe = f"{place[1]}:{place[2]}" if place and place[1] else "built-in"
            elif line.startswith("#  Also makes: "):
                file.also = line.split(": ", 1)[1].split()
            elif line.startswith("#  Implicit/static pattern stem: "):
                file.stem = line.split(": ", 1)[1].strip("'")
    return files


def ask_make(words):
    """What has to be made, in make's order, and all files. A dry run; recipes that call $(MAKE) are not followed."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    environment["LC_ALL"] = "C"
    try:
        asked = subprocess.run(["make", "-n", "-p", "--debug=b", *words, "MAKE=:"], env=environment, text=True,
                               stdin=subprocess.DEVNULL, capture_output=True, errors="surrogateescape")
    except FileNotFoundError:
        raise Failure(NO_DEVICE, "there is no make: apt-get install make")
    if asked.returncode != 0:
        raise Failure(BAD_DATA, asked.stderr.strip() or f"make -n ended with status {asked.returncode}")
    says, _, base = asked.stdout.rpartition("\n# Make data base, printed on ")
    base = base.partition("\n# Files\n")[2].partition("\n# files hash-table stats:")[0]
    return re.findall(r"^ *Must remake target '(.*)'\.$", says, re.MULTILINE), read_files(base)


def find_jobs(must, files):
    """The recipes to be run and what each waits for, prerequisites first."""
    jobs = {}  # by each name that they make
    ordered = []
    for name in must:
        if name not in files:
            raise Failure(BAD_DATA, f"make's data base does not say how {name} is made")
        file = files[name]
        if not file.recipe or name in jobs:
            continue
        names = [name] + [other for other in file.also if other != name]
        job = Job(names, file)
        ordered.append(job)
        jobs.update(dict.fromkeys(names, job))
    for job in ordered:
        seen = set()
        ahead = [(name, True) for name in job.names]
        while ahead:  # through what needs no recipe
            name, newer = ahead.pop()
            if (name, newer) in seen or name not in files:
                continue
            seen.add((name, newer))
            file = files[name]
            for names, counts in ((file.normal, newer), (file.order_only, False)):
                for other in names:
                    needed = jobs.get(other)
                    if needed is None:
                        ahead.append((other, counts))
                    elif needed is not job:
                        job.needs[id(needed)] = needed
                        if counts:
                            job.newer.add(id(needed))
    return ordered


def set_depths(jobs):
    """The longest chain of jobs below each."""
    for first in jobs:
        stack = [first]
        while stack:
            job = stack[-1]
            open_needs = [n for n in job.needs.values() if n.depth is None]
            if job.depth is None and open_needs:
                if len(stack) > len(jobs):
                    raise Failure(BAD_DATA, f"{job.names[0]} needs itself")
                stack.append(open_needs[0])
            else:
                job.depth = 1 + max((n.depth for n in job.needs.values()), default=-1)
                stack.pop()


def patterns(job):
    """The job's name with its stem replaced, wherever that stands: data/%.csv, d%ta/a.csv."""
    name, stem = job.names[0], job.file.stem
    return {name[:i] + "%" + name[i + len(stem):] for i in range(len(name)) if stem and name.startswith(stem, i)}


class Array:
    def __init__(self, number, jobs):
        self.number, self.jobs = number, jobs  # by index
        self.id, self.most = None, 0
        first, *_, last = [*jobs.values()] * 2
        common = patterns(first) & patterns(last) if len(jobs) > 1 else set()
        self.name = min(common, default=first.names[0])

    def indices(self):
        """0-3,5,7-8, and how many of them at once."""
        runs = []
        for index in sorted(self.jobs):
            if runs and runs[-1][1] == index - 1:
                runs[-1][1] = index
            else:
                runs.append([index, index])
        text = ",".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)
        return text + (f"%{self.most}" if 0 < self.most < len(self.jobs) else "")

    def dependency(self, name_of):
        """sbatch's --dependency; name_of(array) is the job's number. '' where there is none."""
        whole, single = {}, {}
        needed = {id(n.array): n.array for job in self.jobs.values() for n in job.needs.values()}
        for other in needed.values():
            alike = all([n.index for n in job.needs.values() if n.array is other] == [index]
                        for index, job in self.jobs.items())
            (single if alike else whole)[other.number] = name_of(other)
        words = [kind + "".join(":" + found[number] for number in sorted(found))
                 for kind, found in (("afterok", whole), ("aftercorr", single)) if found]
        return ",".join(words)


def make_arrays(jobs, largest, most):
    """One array for a rule and a depth, or several where there are more elements than `largest`."""
    groups = defaultdict(list)
    for job in jobs:
        groups[job.depth, job.file.recipe].append(job)
    arrays, group_of = [], {}
    for key in sorted(groups, key=lambda key: key[0]):
        group = groups[key]
        # Indices as those of a group below that has one element for each of these.
        indices = list(range(len(group)))
        for below in dict.fromkeys(group_of[id(n)] for n in group[0].needs.values()):
            matches = [[n.index for n in job.needs.values() if group_of[id(n)] == below] for job in group]
            if all(len(m) == 1 for m in matches) and len({m[0] for m in matches}) == len(group):
                indices = [m[0] for m in matches]
                break
        chunks = defaultdict(dict)
        for index, job in zip(indices, group):
            job.index = index
            group_of[id(job)] = key
            chunks[index // largest][index] = job
        for chunk in sorted(chunks):
            array = Array(len(arrays), {index % largest: job for index, job in sorted(chunks[chunk].items())})
            array.most = max(1, most // len(chunks)) if most else 0
            arrays.append(array)
    for array in arrays:
        for index, job in array.jobs.items():
            job.index, job.array = index, array
    return arrays


def element_words(job, words):
    """make's words for one element: what it needs counts as made, and as new unless it is order-only."""
    given = []
    for key, needed in job.needs.items():
        for name in needed.names:
            given += ["-o", name] + (["-W", name] if key in job.newer else [])
    return ["make", "--eval=.SECONDARY:", "--eval=.DELETE_ON_ERROR:", *given, *words, job.names[0]]
