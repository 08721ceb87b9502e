"""Tables from the results of bench_step.

table.py STEPS.json STEPS.md [STEPS.csv]       medians as Markdown, and as rows of numbers; those of finite
                                               elements go to fem.md beside STEPS.md
table.py --merge STEPS.json PART.json [...]    one file out of several of one run
table.py --update PAGE.md TABLE.md [TABLE.md]  puts tables into a page, between its lines
                                               <!-- begin NAME --> and <!-- end NAME -->
"""
import csv
import json
import os
import sys


def bare(name):
    return name.replace("/real_time", "").replace("/manual_time", "")


def medians(results):
    """Maps names without the suffixes of google-benchmark to entries; plain runs if nothing was repeated."""
    entries = {}
    for entry in results["benchmarks"]:
        if entry.get("error_occurred"):
            print(f"bench: {entry['name']}: {entry['error_message']}", file=sys.stderr)
            continue
        if entry["run_type"] == "aggregate" and entry["aggregate_name"] != "median":
            continue
        entries[bare(entry["run_name"])] = entry
    return entries


def spread(results, name):
    for entry in results["benchmarks"]:
        if entry.get("aggregate_name") == "cv" and bare(entry["run_name"]) == name:
            return entry["real_time"]
    return None


MILLISECONDS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


def conditions(results):
    context = results["context"]
    busy = float(context["load_at_start"].split()[0]) > 0.5 * context["num_cpus"]
    return (f"gneiss {context['gneiss']}, {context['num_cpus']} x {context['cpu']}, widest set {context['isa']}, "
            f"{context['date'][:16]}, load average {context['load_at_start'].split()[0]} at the start; medians."
            + (" **The machine was shared with other work.**" if busy else ""))


def common_cells(results, entries, name, rate):
    """Rows of a whole step: milliseconds, speed-up relative to one thread, scatter of the repetitions."""
    e = entries[name]
    single = entries.get(name.replace(f"threads:{e['threads']:.0f}", "threads:1"))
    ratio = f"{e[rate] / single[rate]:.2f}" if single and e["threads"] > 1 else ""
    cv = spread(results, name)
    return (f"{e['real_time'] * MILLISECONDS[e['time_unit']]:.3f}", ratio, "" if cv is None else f"{100 * cv:.0f} %")


def step_table(results, entries):
    lines = ["| whole step | threads | set | ms/step | Mcs/s | ns/contact | Mps/s | B/contact | rebuilds per 1000 | "
             "lists | speed-up | +- |", "| --- |" + " ---: |" * 11]
    for name, e in entries.items():
        kind, model, how, *_ = name.split("/")
        if kind != "step" or how == "copies":
            continue
        time, ratio, scatter = common_cells(results, entries, name, "contact-steps")
        lines.append(
            f"| {model} | {e['threads']:.0f} | {e['label']} | {time} | "
            f"{e['contact-steps'] / 1e6:.1f} | {e['per contact-step'] * 1e9:.2f} | {e['particle-steps'] / 1e6:.1f} | "
            f"{e['B/contact']:.0f} | {e['rebuilds/1000 steps']:.1f} | {100 * e['lists']:.1f} % | {ratio} | "
            f"{scatter} |")
    return lines if len(lines) > 2 else []


def copies_table(entries):
    """Speed-up of two threads without shared data, an upper bound of the speed-up of two threads of one world."""
    lines = ["| one model on two threads, two models at once | 1 thread, ms/step | 2 threads | speed-up | two models, 1 thread "
             "each: half a step of either | speed-up that the machine allows | reached |", "| --- |" + " ---: |" * 6]
    for name, e in entries.items():
        kind, model, how, *rest = name.split("/")
        pair = [entries.get("/".join([kind, model, f"threads:{n}", *rest])) for n in (1, 2)]
        if how != "copies" or None in pair:
            continue
        one, two, both = (x["real_time"] * MILLISECONDS[x["time_unit"]] for x in (*pair, e))
        lines.append(f"| {model} | {one:.3f} | {two:.3f} | {one / two:.2f} | {both:.3f} | {one / both:.2f} | "
                     f"{100 * both / two:.0f} % |")
    return lines if len(lines) > 2 else []


def effect_table(entries):
    """Rows by processor time, which other work on the machine disturbs least."""
    effects = {n.split("/")[1]: e for n, e in entries.items() if n.startswith("effect/")}
    if "none" not in effects:
        return []
    cost = {n: 1e6 * MILLISECONDS[e["time_unit"]] * e["cpu_time"] / e["contacts"] for n, e in effects.items()}
    lines = ["| effect alone, 1 thread | ns/contact (CPU) | times the bare step | B/contact | B/particle |",
             "| --- |" + " ---: |" * 4]
    for name, e in effects.items():
        lines.append(f"| {name} | {cost[name]:.2f} | {cost[name] / cost['none']:.2f} | {e['B/contact']:.0f} | "
                     f"{e['B/particle']:.0f} |")
    return lines


# Additions and multiplications per contact, counted in docs/evidence/performance.md; mixed has 12 more for the stretch.
OPERATIONS = {"rock-a": 135, "rock-a-mixed": 147, "fcc-32k": 144, "fcc-32k-mixed": 147}


def roof(context, operations, moved, data, precision="double"):
    """Items per second that arithmetic or the stream allow, whichever is less, on one core."""
    arithmetic = float(context[f"limit_gflops_{precision}"]) / operations
    stream = float(context["limit_gbs_cached" if data == "cached" else "limit_gbs_far"]) / moved
    return 1e9 * min(arithmetic, stream), "arithmetic" if arithmetic < stream else "stream"


def kernel_table(results, entries):
    context = results["context"]
    lines = [f"Roofs of one core: {float(context['limit_gflops_double']):.0f} Gflop/s in double and "
             f"{float(context['limit_gflops_single']):.0f} in single precision (fused multiply-adds, widest set), "
             f"{float(context['limit_gbs_cached']):.0f} GB/s from the second-level cache (\"cached\"), "
             f"{float(context['limit_gbs_far']):.0f} GB/s from 96 MB (\"all\"); the share is of the lower one.", "",
             "| kernel alone, 1 thread | scene | set | data | ns/item | M items/s | B read | B written | GB/s | Gflop/s "
             "| share of the roof |", "| --- | --- | --- | --- |" + " ---: |" * 7]
    head = len(lines)
    for name, e in entries.items():
        kind, model, *rest = name.split("/")
        if kind not in ("contact", "motion"):
            continue
        item = "contact-step" if kind == "contact" else "particle-step"
        traffic = " | | | | "
        if kind == "contact":
            precision = "single" if model.endswith("-mixed") else "double"
            most, what = roof(context, OPERATIONS[model], e["B read"] + e["B written"], rest[1], precision)
            share = f"{100 * e[item + 's'] / most:.0f} % of {what}" if rest[0] == context["isa"] else ""
            traffic = (f"{e['B read']:.0f} | {e['B written']:.0f} | {e['traffic'] / 1e9:.1f} | "
                       f"{1e-9 * OPERATIONS[model] * e[item + 's']:.1f} | {share}")
        lines.append(f"| {e['label'].split()[1]} | {model} | {rest[0]} | {rest[1]} | {e['per ' + item] * 1e9:.2f} | "
                     f"{e[item + 's'] / 1e6:.1f} | {traffic} |")
    return lines if len(lines) > head else []


def fem_variant(model):
    """Rows of a block: the mixed form, the displacement form with forces in single precision, or it in double."""
    return next((v for v in (" mixed", " single") if model.endswith(v.replace(" ", "-"))), "")


def fem_table(results, entries):
    steps = ["| finite elements, whole step | elements | nodes | threads | set | ms/step | M element-steps/s | ns/element | "
             "of the displacement form in double | speed-up | +- |", "| --- |" + " ---: |" * 10]
    kernels = ["| element kernel alone, 1 thread | set | data | ns/element | M elements/s | B columns | B rows | GB/s | "
               "Gflop/s | share of the roof |", "| --- | --- | --- |" + " ---: |" * 7]
    heads = len(steps) + len(kernels)
    for name, e in entries.items():
        kind, model, *rest = name.split("/")
        if kind == "fem":
            time, ratio, scatter = common_cells(results, entries, name, "element-steps")
            variant = fem_variant(model)
            plain = entries.get(name.replace(f"-{variant.strip()}/", "/")) if variant else None
            cost = f"{e['per element-step'] / plain['per element-step']:.2f}" if plain else ""
            steps.append(
                f"| {model[:2].upper()}{variant} | {e['elements']:.0f} | {e['nodes']:.0f} | {e['threads']:.0f} | {e['label']} | "
                f"{time} | {e['element-steps'] / 1e6:.1f} | {e['per element-step'] * 1e9:.2f} | {cost} | {ratio} | {scatter} |")
        elif kind == "element":
            moved = e["B columns"] + e["B rows"]
            precision = "single" if fem_variant(model) == " single" else "double"
            most, what = roof(results["context"], e["operations"], moved, rest[1], precision)
            share = f"{100 * e['element-steps'] / most:.0f} % of {what}" if rest[0] == results["context"]["isa"] else ""
            kernels.append(
                f"| {model[:2].upper()}{fem_variant(model)} | {rest[0]} | {rest[1]} | {e['per element-step'] * 1e9:.2f} | "
                f"{e['element-steps'] / 1e6:.1f} | {e['B columns']:.0f} | {e['B rows']:.0f} | "
                f"{1e-9 * moved * e['element-steps']:.1f} | {1e-9 * e['operations'] * e['element-steps']:.1f} | {share} |")
    return [*steps, "", *kernels] if len(steps) + len(kernels) > heads else []


GOOGLE_KEYS = {"name", "run_name", "run_type", "repetitions", "repetition_index", "family_index",
               "per_family_instance_index", "threads", "aggregate_name", "aggregate_unit", "iterations", "real_time",
               "cpu_time", "time_unit", "label"}


def write_csv(results, entries, target):
    """One row per bench, with the place of the measurement; counters that a bench does not have stay empty."""
    context = results["context"]
    stamp = [context[k] for k in ("date", "gneiss", "cpu", "num_cpus", "load_at_start")]
    counters = sorted({key for e in entries.values() for key in e if key not in GOOGLE_KEYS})
    with open(target, "w", encoding="utf-8", newline="") as f:
        out = csv.writer(f)
        out.writerow(["date", "gneiss", "cpu", "cpus", "load_at_start", "kind", "model", "variant", "label", "threads",
                      "ms", "cpu_ms", "cv", *counters])
        for name, e in entries.items():
            kind, model, *rest = name.split("/")
            cv, unit = spread(results, name), MILLISECONDS[e["time_unit"]]
            out.writerow([*stamp, kind, model, "/".join(rest), e.get("label", ""), f"{e['threads']:.0f}",
                          f"{e['real_time'] * unit:.6g}", f"{e['cpu_time'] * unit:.6g}",
                          "" if cv is None else f"{cv:.3g}",
                          *("" if c not in e else f"{e[c]:.6g}" for c in counters)])


def write_tables(source, target, rows=None):
    with open(source, encoding="utf-8") as f:
        results = json.load(f)
    entries = medians(results)
    if rows:
        write_csv(results, entries, rows)
    parts = [[conditions(results)], step_table(results, entries), copies_table(entries),
             effect_table(entries), kernel_table(results, entries)]
    elements = [[conditions(results)], fem_table(results, entries)]
    for place, tables in ((target, parts), (os.path.join(os.path.dirname(target), "fem.md"), elements)):
        with open(place, "w", encoding="utf-8") as f:
            f.write("\n\n".join("\n".join(p) for p in tables if p) + "\n")


def rank(entry, sets):
    """Sort by threads, instruction set, and cached before all: in turns they occur in any order."""
    words = entry["run_name"].split("/")
    threads = next((int(w[8:]) for w in words if w.startswith("threads:")), 0)
    return threads, next((sets.index(w) for w in words if w in sets), -1), "all" in words


def merge(target, parts):
    """A file with the conditions of the first file and the results of all."""
    merged = None
    for part in parts:
        with open(part, encoding="utf-8") as f:
            results = json.load(f)
        sets = results["context"]["isas"].split()
        results["benchmarks"].sort(key=lambda entry: rank(entry, sets))
        if merged is None:
            merged = results
        else:
            merged["benchmarks"] += results["benchmarks"]
    with open(target, "w", encoding="utf-8") as f:
        json.dump(merged, f, indent=1)


def update(page, tables):
    with open(page, encoding="utf-8") as f:
        text = f.read()
    for table in tables:
        if not os.path.exists(table):
            continue
        name = os.path.splitext(os.path.basename(table))[0]
        begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->"
        if begin not in text or end not in text:
            sys.exit(f"table.py: {page}: expected the lines {begin.strip()} and {end}, found none")
        with open(table, encoding="utf-8") as f:
            text = text[:text.index(begin) + len(begin)] + "\n" + f.read() + "\n" + text[text.index(end):]
    with open(page, "w", encoding="utf-8") as f:
        f.write(text)


if __name__ == "__main__":
    if len(sys.argv) >= 4 and sys.argv[1] == "--update":
        update(sys.argv[2], sys.argv[3:])
    elif len(sys.argv) >= 4 and sys.argv[1] == "--merge":
        merge(sys.argv[2], sys.argv[3:])
    elif len(sys.argv) in (3, 4):
        write_tables(*sys.argv[1:])
    else:
        sys.exit(__doc__)
