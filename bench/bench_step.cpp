// Benches of whole steps, of single effects and of kernels alone.
//
//   bench_step [--scenes DIR] [--large] [--sweep] [google-benchmark options]
//
// --large adds specimens beyond the caches, --sweep the frictional lattice from 1 372 to 1 000 188
// grains.
//
// A world is made once and shared by the benches that differ only in threads and instruction set.
// Times are wall times; one iteration is one step (or one sweep of a kernel).
#include "bench_fem.h"
#include "bench_world.h"
#include "limits.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

struct Model {
    std::string name, scene, extra;
    std::vector<std::string> overrides;
    int warm; // steps before the clock starts
};

struct Setting {
    int threads;
    std::string isa;
};

std::string scenes_folder = BENCH_SCENES;

std::vector<std::string> isas() {
    std::vector<std::string> names;
    while (const char *name = bench_isa_at(static_cast<int>(names.size()))) names.push_back(name);
    return names;
}

std::string widest_isa() {
    return isas().back();
}

std::string list_of(const std::vector<std::string> &names) {
    std::string list;
    for (const std::string &name : names) list += (list.empty() ? "" : " ") + name;
    return list;
}

using World = std::unique_ptr<bench_world, decltype(&bench_world_free)>;

enum { COPIES = 2 };

// The world of the last requested model, or another one like it; benches are registered model by
// model.
bench_world *world_of(const Model &model, std::string *message, int copy = 0) {
    static World worlds[COPIES] = {{nullptr, bench_world_free}, {nullptr, bench_world_free}};
    static std::string names[COPIES];
    World &world = worlds[copy];
    std::string &held = names[copy];
    if (held == model.name) return world.get();
    held.clear();
    world.reset();
    std::vector<const char *> overrides;
    for (const std::string &o : model.overrides) overrides.push_back(o.c_str());
    overrides.push_back(nullptr);
    char text[BENCH_MESSAGE_SIZE] = "";
    std::string path = scenes_folder + "/" + model.scene;
    world.reset(bench_world_create(path.c_str(), model.extra.c_str(), overrides.data(), text));
    if (world && (!bench_world_use(world.get(), 1, "auto") ||
                  !bench_world_steps(world.get(), model.warm, text)))
        world.reset();
    *message = text;
    if (world) held = model.name;
    return world.get();
}

bench_world *prepare(benchmark::State &state, const Model &model, const Setting &setting,
                     int copy = 0) {
    std::string message;
    bench_world *world = world_of(model, &message, copy);
    if (!world) {
        state.SkipWithError(message.c_str());
    } else if (!bench_world_use(world, setting.threads, setting.isa.c_str())) {
        state.SkipWithError("this machine has no such instruction set");
        return nullptr;
    }
    return world;
}

// `items` is over all iterations; google-benchmark prints items per second and seconds per item.
void rate(benchmark::State &state, const char *items_name, const char *time_name, double items) {
    using benchmark::Counter;
    state.counters[items_name] = Counter(items, Counter::kIsRate);
    state.counters[time_name] = Counter(items, Counter::kIsRate | Counter::kInvert);
}

void step(benchmark::State &state, const Model &model, const Setting &setting) {
    bench_world *world = prepare(state, model, setting);
    if (!world) return;
    bench_numbers before = bench_world_numbers(world);
    char message[BENCH_MESSAGE_SIZE];
    auto start = std::chrono::steady_clock::now();
    for (auto _ : state) {
        if (bench_world_steps(world, 1, message)) continue;
        state.SkipWithError(message);
        break;
    }
    std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    double seconds = elapsed.count();
    bench_numbers after = bench_world_numbers(world);
    double contacts = static_cast<double>(after.contact_steps - before.contact_steps);
    double steps = static_cast<double>(after.steps - before.steps);
    rate(state, "contact-steps", "per contact-step", contacts);
    rate(state, "particle-steps", "per particle-step",
         steps * static_cast<double>(after.particles));
    bool bonded = after.bonds > after.pairs;
    state.counters["B/contact"] = static_cast<double>(bonded ? after.bond_bytes : after.pair_bytes);
    state.counters["B/particle"] = static_cast<double>(after.particle_bytes);
    state.counters["contacts"] = static_cast<double>(after.bonds + after.pairs);
    state.counters["bonds"] = static_cast<double>(after.bonds);
    state.counters["particles"] = static_cast<double>(after.particles);
    state.counters["threads"] = after.threads;
    state.counters["rebuilds/1000 steps"] =
        steps > 0 ? 1000.0 * static_cast<double>(after.rebuilds - before.rebuilds) / steps : 0.0;
    state.counters["lists"] = (after.seconds_lists - before.seconds_lists) / seconds;
    state.SetLabel(after.isa);
}

// Bench of two worlds at the same time, one thread each, that share nothing but the machine: the
// bound of the speed-up with two threads. The time is that of a step over the number of worlds.
void copies(benchmark::State &state, const Model &model, const Setting &setting) {
    bench_world *worlds[COPIES];
    for (int k = 0; k < COPIES; k++) {
        worlds[k] = prepare(state, model, setting, k);
        if (!worlds[k]) return;
    }
    const auto count = [&] {
        bench_numbers n = bench_world_numbers(worlds[0]);
        return static_cast<double>(n.contact_steps);
    };
    const double before = count();
    char message[BENCH_MESSAGE_SIZE];
    for (auto _ : state) {
        double seconds[COPIES], mean = 0.0;
        if (!bench_worlds_at_once(worlds, COPIES, seconds, message)) {
            state.SkipWithError(message);
            break;
        }
        for (double s : seconds) mean += s / COPIES;
        state.SetIterationTime(mean / COPIES);
    }
    rate(state, "contact-steps", "per contact-step", count() - before);
    state.counters["threads"] = COPIES;
    state.SetLabel(bench_world_numbers(worlds[0]).isa);
}

void contact_kernel(benchmark::State &state, const Model &model, const Setting &setting,
                    std::size_t blocks) {
    bench_world *world = prepare(state, model, setting);
    if (!world) return;
    double contacts = 0.0;
    for (auto _ : state) contacts += static_cast<double>(bench_world_contact_kernel(world, blocks));
    std::size_t read, written;
    bench_world_contact_traffic(world, &read, &written);
    rate(state, "contact-steps", "per contact-step", contacts);
    state.counters["B read"] = static_cast<double>(read);
    state.counters["B written"] = static_cast<double>(written);
    state.counters["traffic"] = benchmark::Counter(contacts * static_cast<double>(read + written),
                                                   benchmark::Counter::kIsRate);
    state.counters["threads"] = 1;
    char name[200];
    bench_world_contact_name(world, name, sizeof name);
    state.SetLabel(std::string(bench_world_numbers(world).isa) + " " + name);
}

void motion_kernel(benchmark::State &state, const Model &model, const Setting &setting,
                   std::size_t blocks) {
    bench_world *world = prepare(state, model, setting);
    if (!world) return;
    double particles = 0.0;
    for (auto _ : state) particles += static_cast<double>(bench_world_motion_kernel(world, blocks));
    rate(state, "particle-steps", "per particle-step", particles);
    state.counters["threads"] = 1;
    char name[200];
    bench_world_motion_name(world, name, sizeof name);
    state.SetLabel(std::string(bench_world_numbers(world).isa) + " " + name);
}

// --- benches
// -------------------------------------------------------------------------------------

std::string title(const char *kind, const Model &model, const Setting &setting) {
    return std::string(kind) + "/" + model.name + "/threads:" + std::to_string(setting.threads) +
           "/" + setting.isa;
}

void add_step(const char *kind, const Model &model, const Setting &setting) {
    benchmark::RegisterBenchmark(title(kind, model, setting).c_str(),
                                 [=](benchmark::State &state) { step(state, model, setting); })
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

void add_copies(const Model &model) {
    const std::string widest = widest_isa();
    benchmark::RegisterBenchmark(("step/" + model.name + "/copies/" + widest).c_str(),
                                 [=](benchmark::State &state) {
                                     copies(state, model, Setting{1, widest});
                                 })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

using KernelBench = void (*)(benchmark::State &, const Model &, const Setting &, std::size_t);

// `cached`: only the first blocks, which stay in the second-level cache.
void add_kernel(const char *kind, KernelBench bench, const Model &model, const std::string &isa,
                std::size_t blocks, bool cached) {
    std::string name =
        std::string(kind) + "/" + model.name + "/" + isa + (cached ? "/cached" : "/all");
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](benchmark::State &state) {
                                     bench(state, model, Setting{1, isa}, blocks);
                                 })
        ->UseRealTime()
        ->Unit(benchmark::kMicrosecond);
}

void add_kernels(const Model &model) {
    const std::size_t all = static_cast<std::size_t>(1) << 40;
    for (const std::string &isa : isas()) {
        add_kernel("contact", contact_kernel, model, isa, 16, true);
        add_kernel("contact", contact_kernel, model, isa, all, false);
        add_kernel("motion", motion_kernel, model, isa, 8, true);
        add_kernel("motion", motion_kernel, model, isa, all, false);
    }
}

void add_steps(const Model &model, bool each_isa) {
    const std::string widest = widest_isa();
    for (int threads : {1, 2})
        for (const std::string &isa : isas())
            if (each_isa || isa == widest) add_step("step", model, Setting{threads, isa});
}

Model with(const Model &base, const std::string &name, const std::vector<std::string> &overrides) {
    Model model = base;
    model.name = name;
    model.overrides.insert(model.overrides.end(), overrides.begin(), overrides.end());
    return model;
}

Model mixed(const Model &base) {
    return with(base, base.name + "-mixed", {"run.precision=mixed"});
}

// fcc lattice of the frictional scene with n cells along each edge.
Model fcc(const std::string &name, int n) {
    const double edge = 1.4024821086288453; // (4/1.45)^(1/3)
    char box[128], cells[64];
    std::snprintf(box, sizeof box, "periodic.max=[%.17g, %.17g, %.17g]", n * edge, n * edge,
                  n * edge);
    std::snprintf(cells, sizeof cells, "specimen.lattice.cells=[%d, %d, %d]", n, n, n);
    return {name, "fcc-frictional.yaml", "", {box, cells}, 20};
}

// Each effect by itself on top of the bare lattice.
void add_effects() {
    const int n = 16;
    char cells[64];
    std::snprintf(cells, sizeof cells, "specimen.lattice.cells=[%d, %d, %d]", n, n, n);
    const Model bare = {"bare", "lattice.yaml", "", {cells}, 20};
    const std::string box = "periodic: {min: [0, 0, 0], max: [22.62514738, 22.62514738, "
                            "22.62514738]}\n"; // 16 edges of 0.9999 sqrt(2)
    struct Effect {
        const char *name;
        std::vector<std::string> overrides;
        std::string extra;
    };
    const std::string back = "damping.background.";
    const std::vector<Effect> effects = {
        {"none", {}, ""},
        {"rotation", {"law.rotation=on"}, ""},
        {"shear+friction", {"materials.grain.kratio=3.5", "materials.grain.friction=0.5"}, ""},
        {"shear+friction+rotation",
         {"materials.grain.kratio=3.5", "materials.grain.friction=0.5", "law.rotation=on"},
         ""},
        {"bonds", {}, "bonds: {interaction_range: 0.05}\n"},
        {"bonds+shear", {"materials.grain.kratio=3.5"}, "bonds: {interaction_range: 0.05}\n"},
        {"contact_damping", {}, "damping: {contact: {fraction: 0.1}}\n"},
        {"viscous", {}, "damping: {background: {model: viscous, coefficient: 1}}\n"},
        {"nonviscous_vector",
         {},
         "damping: {background: {model: nonviscous_vector, coefficient: 0.1}}\n"},
        {"nonviscous_component",
         {},
         "damping: {background: {model: nonviscous_component, coefficient: 0.1}}\n"},
        {"gravity", {}, "gravity: [0, 0, -1e-3]\n"},
        {"applied", {}, "sets: [{name: top, select: {all: true}, force: [0, 0, 1e-3]}]\n"},
        {"prescribed",
         {},
         "sets: [{name: low, select: {end: {axis: z, side: lower, depth: 1}}, motion: {vz: "
         "0}}]\n"},
        {"walls",
         {},
         "walls: [{name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2000}]\n"},
        {"periodic", {}, box},
        {"orientation+rotation", {"law.rotation=on", "output.orientation=on"}, ""},
        {"energy", {"output.energy=on"}, ""},
    };
    for (const Effect &effect : effects) {
        Model model = with(bare, effect.name, effect.overrides);
        model.extra = effect.extra;
        add_step("effect", model, Setting{1, widest_isa()});
    }
}

// --- finite elements
// -------------------------------------------------------------------------------------

struct Block {
    std::string name;
    int dimension, cells;
    bench_fem_kind kind = BENCH_FEM_DOUBLE;
};

Block mixed(Block block) {
    block.name += "-mixed";
    block.kind = BENCH_FEM_PRESSURE;
    return block;
}

// Forces in single precision; not the pressure form.
Block single(Block block) {
    block.name += "-single";
    block.kind = BENCH_FEM_SINGLE;
    return block;
}

using Fem = std::unique_ptr<bench_fem, decltype(&bench_fem_free)>;

void fem_counters(benchmark::State &state, const bench_fem *fem, double elements) {
    double columns, rows, operations;
    bench_fem_traffic(fem, &columns, &rows, &operations);
    rate(state, "element-steps", "per element-step", elements);
    state.counters["elements"] = static_cast<double>(bench_fem_elements(fem));
    state.counters["nodes"] = static_cast<double>(bench_fem_nodes(fem));
    state.counters["B columns"] = columns;
    state.counters["B rows"] = rows;
    state.counters["operations"] = operations;
    state.SetLabel(bench_fem_isa(fem));
}

void fem_bench(benchmark::State &state, const Block &block, const Setting &setting,
               std::size_t blocks) {
    char message[BENCH_MESSAGE_SIZE] = "";
    Fem fem(bench_fem_create(block.dimension, block.kind, block.cells, setting.threads,
                             setting.isa.c_str(), message),
            bench_fem_free);
    if (!fem || !bench_fem_steps(fem.get(), 3, message)) {
        state.SkipWithError(message);
        return;
    }
    double elements = 0.0;
    for (auto _ : state) {
        if (blocks > 0) {
            elements += static_cast<double>(bench_fem_kernel(fem.get(), blocks));
        } else {
            elements += static_cast<double>(bench_fem_elements(fem.get()));
            if (!bench_fem_steps(fem.get(), 1, message)) state.SkipWithError(message);
        }
    }
    fem_counters(state, fem.get(), elements);
    state.counters["threads"] = setting.threads;
}

void add_fem_bench(const std::string &name, const Block &block, const Setting &setting,
                   std::size_t blocks) {
    benchmark::RegisterBenchmark(
        name.c_str(), [=](benchmark::State &state) { fem_bench(state, block, setting, blocks); })
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

void add_fem(const Block &block, bool kernels) {
    const std::string widest = widest_isa();
    for (int threads : {1, 2})
        add_fem_bench("fem/" + block.name + "/threads:" + std::to_string(threads) + "/" + widest,
                      block, Setting{threads, widest}, 0);
    for (const std::string &isa : kernels ? isas() : std::vector<std::string>{})
        for (bool cached : {true, false})
            add_fem_bench("element/" + block.name + "/" + isa + (cached ? "/cached" : "/all"),
                          block, Setting{1, isa}, cached ? 8 : static_cast<std::size_t>(1) << 40);
}

struct Wanted {
    bool large, sweep;
};

void add_all(Wanted wanted) {
    const Model rock = {"rock-a", "../../scenes/ucs-rock.yaml", "", {}, 20};
    const Model small = fcc("fcc-32k", 20);
    add_steps(rock, true);
    add_copies(rock);
    add_kernels(rock);
    add_steps(mixed(rock), true);
    add_copies(mixed(rock));
    add_kernels(mixed(rock));
    add_steps(with(rock, "rock-a-no-energy", {"output.energy=off"}), false);
    add_steps(small, true);
    add_kernels(small);
    add_steps(mixed(small), true);
    add_kernels(mixed(small));
    add_steps(with(small, "fcc-32k-energy", {"output.energy=on"}), false);
    add_steps({"chute", "chute.yaml", "", {}, 3000}, false);
    if (wanted.sweep)
        for (int n : {7, 14, 30, 63}) {
            const Model model = fcc("fcc-" + std::to_string(4 * n * n * n), n);
            add_steps(model, false);
            add_steps(mixed(model), false);
        }
    if (wanted.large || wanted.sweep) {
        const Model large = fcc("fcc-500k", 50);
        for (const Model &model : {large, mixed(large)}) {
            add_steps(model, false);
            add_copies(model);
        }
    }
    if (wanted.large) {
        add_steps({"bonded-108k",
                   "lattice.yaml",
                   "bonds: {interaction_range: 0.05}\n",
                   {"specimen.lattice.cells=[30, 30, 30]", "law.rotation=on",
                    "materials.grain.kratio=3.5", "materials.grain.friction=0.5"},
                   20},
                  false);
    }
    add_effects();
    std::vector<Block> blocks = {{"t3-40k", 2, 141}, {"t4-40k", 3, 20}};
    if (wanted.large || wanted.sweep) {
        for (int cells : {22, 700})
            blocks.push_back({"t3-" + std::to_string(2 * cells * cells), 2, cells});
        for (int cells : {6, 58})
            blocks.push_back({"t4-" + std::to_string(5 * cells * cells * cells), 3, cells});
    }
    for (const Block &block : blocks) {
        const bool kernels = block.cells == 141 || block.cells == 20;
        add_fem(block, kernels);
        add_fem(single(block), kernels);
        add_fem(mixed(block), false);
    }
}

std::string cpu_model() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.compare(0, 10, "model name") == 0) return line.substr(line.find(':') + 2);
    return "unknown";
}

std::string first_line(const char *path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    return line;
}

// The roofs of one core: arithmetic, and streams from the second-level cache and from memory.
void add_limits() {
    const auto giga = [](double rate) { return std::to_string(1e-9 * rate); };
    benchmark::AddCustomContext("limit_gflops_double", giga(bench_limit_flops(0)));
    benchmark::AddCustomContext("limit_gflops_single", giga(bench_limit_flops(1)));
    benchmark::AddCustomContext("limit_gbs_cached",
                                giga(bench_limit_triad(static_cast<std::size_t>(1) << 20)));
    benchmark::AddCustomContext("limit_gbs_far",
                                giga(bench_limit_triad(static_cast<std::size_t>(96) << 20)));
}

// Removes the program's own options from argv; google-benchmark reads the rest.
Wanted own_options(int *argc, char **argv) {
    Wanted wanted = {false, false};
    int kept = 1;
    for (int k = 1; k < *argc; k++) {
        if (std::strcmp(argv[k], "--large") == 0)
            wanted.large = true;
        else if (std::strcmp(argv[k], "--sweep") == 0)
            wanted.sweep = true;
        else if (std::strcmp(argv[k], "--scenes") == 0 && k + 1 < *argc)
            scenes_folder = argv[++k];
        else
            argv[kept++] = argv[k];
    }
    argv[kept] = nullptr;
    *argc = kept;
    return wanted;
}

} // namespace

int main(int argc, char **argv) {
    Wanted wanted = own_options(&argc, argv);
    benchmark::AddCustomContext("gneiss", std::string(bench_version()) + " " + bench_build());
    benchmark::AddCustomContext("isa", widest_isa());
    benchmark::AddCustomContext("isas", list_of(isas()));
    benchmark::AddCustomContext("cpu", cpu_model());
    benchmark::AddCustomContext("load_at_start", first_line("/proc/loadavg"));
    bool lists = false;
    for (int k = 1; k < argc; k++)
        lists = lists || std::strncmp(argv[k], "--benchmark_list", 16) == 0;
    if (!lists) add_limits();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    add_all(wanted);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
