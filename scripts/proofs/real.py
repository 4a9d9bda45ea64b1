# See real: asks the questions, judges the answers, prints the table and gathers the pages.
import html
import json
import os
import subprocess
import sys

questions, folder, runs, *only = sys.argv[1:]


def answer(question):
    """The explained manifest and the entry of the question's domain."""
    here = os.path.join(folder, question["name"])
    os.makedirs(here, exist_ok=True)
    made = subprocess.run(["bash", "-c", question["make"]], cwd=here, stderr=subprocess.PIPE, text=True)
    if not os.path.exists(os.path.join(here, "in.json")) and "explain" not in question:
        raise RuntimeError(made.stderr.strip())
    asked = question.get("explain", "in.json")
    command = f"explain {asked} -o out.json --force --html page.html --log-level error --allow-outside --resample {runs}"
    ended = subprocess.run(["bash", "-c", command], cwd=here, stderr=subprocess.PIPE, text=True)
    if ended.returncode > 2:
        raise RuntimeError(ended.stderr.strip())
    with open(os.path.join(here, "out.json")) as file:
        entries = json.load(file)["explanations"]
    return next(e for e in entries if e["domain"] == question.get("domain", entries[0]["domain"]))


def asked_again(question):
    """What explain names of its own output: nothing, where the answer is carried."""
    here = os.path.join(folder, question["name"])
    ended = subprocess.run("explain out.json -o again.json --force --log-level error --allow-outside", cwd=here, shell=True,
                           stderr=subprocess.PIPE, text=True)
    if ended.returncode > 2:
        return "refused: " + (ended.stderr.strip().splitlines() or [""])[0]
    with open(os.path.join(here, "again.json")) as file:
        entries = json.load(file)["explanations"]
    entry = [e for e in entries if e["domain"] == question.get("domain", entries[-1]["domain"])][-1]
    return "nothing" if entry["verdict"] == "null" else " ".join(sorted(sets_of(entry)[0])) or entry["verdict"]


def sets_of(entry):
    """What stands in the answer: the first set, and those that are listed beside it."""
    first = {n["mechanism"] for n in entry["named"]}
    beside = []
    for group in entry["not_told_apart"]:
        if all(isinstance(part, str) for part in group):
            beside += [(first - {group[0]}) | {other} for other in group[1:]]
        else:
            beside += [set(part) for part in group[1:]]
    return first, beside


def is_right(names, question):
    return names <= set(question["within"]) and (not question["needs"] or names & set(question["needs"]))


def judged(entry, question):
    first, beside = sets_of(entry)
    if entry["verdict"] == "unknown":
        return "honest"
    if is_right(first, question):
        return "right"
    if any(is_right(other, question) for other in beside):
        return "honest"
    return "WRONG ALONE" if entry["verdict"] == "named" else "wrong, with others listed"


def number(score, unit):
    return f"{100 * score:.3g} %" if unit in ("", "1") else f"{score:.3g} {unit}"


def row(question):
    try:
        entry = answer(question)
    except RuntimeError as error:
        return (question, {"sentence": str(error)}, "no answer", "", "", "", "FAILED")
    held, stable = entry["held_out"], entry.get("stability", {"same": 0, "draws": 0})
    first, _ = sets_of(entry)
    change = f"{number(held['before'], held['unit'])} -> {number(held['after'], held['unit'])}"
    return (question, entry, " ".join(sorted(first)) or entry["verdict"], change, f"{stable['same']} of {stable['draws']}",
            asked_again(question), judged(entry, question))


rows = []
with open(questions) as file:
    for q in json.load(file):
        if only and q["name"] not in only:
            continue
        rows.append(row(q))
        _, _, named, change, stable, again, verdict = rows[-1]
        print(f"{q['name']:<22} {named:<52} {change:<24} {stable:>8}  {verdict:<8} then {again}", flush=True)

cells = ""
for q, entry, named, change, stable, again, verdict in rows:
    cells += (f"<tr><td><a href='{q['name']}/page.html'>{q['name']}</a><br>{html.escape(q['question'])}</td>"
              f"<td>{html.escape(entry['sentence'])}</td><td>{change}</td><td>{stable}</td><td>{html.escape(again)}</td>"
              f"<td><b>{verdict}</b><br>{html.escape(q['known'])}</td></tr>")
with open(os.path.join(folder, "real.html"), "w") as page:
    page.write("<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width'>"
               "<title>Real recordings</title><style>body{font:16px/1.45 sans-serif;margin:1em auto;max-width:75em;"
               "padding:0 1em}table{border-collapse:collapse;width:100%}td,th{border-top:1px solid #bbb;padding:.5em;"
               "text-align:left;vertical-align:top}@media(max-width:45em){td,th{display:block;border:0}"
               "tr{display:block;border-top:1px solid #bbb}thead{display:none}}</style>"
               f"<h1>Real recordings</h1><p>Asked of each whole set, and of {runs} parts of it.</p><table><thead><tr><th>set"
               "<th>answer<th>error on what the fit did not see<th>same answer<th>asked of its own output<th>judged, and what is known</tr></thead>"
               f"{cells}</table></html>")

wrong = [q["name"] for q, *_, verdict in rows if verdict in ("WRONG ALONE", "FAILED")]
count = {kind: sum(v.lower().startswith(kind) for *_, v in rows) for kind in ("right", "honest", "wrong")}
print(f"real: {count['right']} right, {count['honest']} honest, {count['wrong']} wrong of {len(rows)}; measured "
      f"{len(wrong)} wrong alone or without an answer required 0{'' if not wrong else '  NOT MET: ' + ' '.join(wrong)}")
sys.exit(1 if wrong else 0)
