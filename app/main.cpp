// The program: reads the command line, runs one command, turns errors into a message and an exit status: 0
// done, 1 failed, 2 misuse, 130 interrupted. Each command's options, help and body are in
// app/commands/NAME.cpp.
#include <omp.h>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "app/commands/bench.h"
#include "app/commands/compare.h"
#include "app/commands/dataset.h"
#include "app/commands/encode.h"
#include "app/commands/export.h"
#include "app/commands/import.h"
#include "app/commands/infer.h"
#include "app/commands/inspect.h"
#include "app/commands/plot.h"
#include "app/commands/render.h"
#include "app/commands/report.h"
#include "app/commands/retrain.h"
#include "app/commands/simulate.h"
#include "app/commands/stability.h"
#include "app/commands/train.h"
#include "app/files/results.h"
#include "app/options/option_list.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/provenance.h"

using namespace wetcurl;

namespace {

// Of every command, beside its CommonOptions.
struct Verbosity {
    bool quiet = false;
    std::string log_level = "info";
};
const std::vector<std::string> log_levels{"debug", "info", "warning", "error", "off"};

template <class Options>
void add_common(OptionList& options, Options& o, Verbosity& verbosity) {
    // What a command refuses is not in its help.
    const auto shown_if = [](bool shown, OptionRow option) {
        if (!shown) option.hidden();
    };
    shown_if(Options::reads_scene,
             options.option("--set", o.set, "key.path=value over the scene's or recipe's (repeatable)")
                 .takes("KEY=VALUE")
                 .repeatable());
    shown_if(Options::uses_device, options.option("--device", o.device, "cpu | cuda[:n]").shows_default());
    options.option("--threads", o.threads, "threads; 0: all").within(0, 4096);
    shown_if(Options::reads_scene, options.option("--seed", o.seed, "seed in place of the file's"));
    options.flag("--overwrite", o.overwrite, "replace an output that is there");
    options.flag("--quiet", verbosity.quiet, "no progress, warnings only");
    options.option("--log-level", verbosity.log_level, "debug | info | warning | error | off")
        .one_of(log_levels);
    if constexpr (Options::writes_json)
        options.option("--json", o.json, "write the results as JSON to this file, - for standard output");
}

void apply(const Verbosity& verbosity, CommonOptions& o) {
    const auto level =
        std::find(log_levels.begin(), log_levels.end(), verbosity.log_level) - log_levels.begin();
    set_log_level(verbosity.quiet && level < 2 ? LogLevel::warning : LogLevel(level));
    Progress::set_quiet(verbosity.quiet);
    if (o.threads == 0) o.threads = omp_get_num_procs();
    omp_set_num_threads(o.threads);
    const bool cuda = o.device.rfind("cuda", 0) == 0;
    if (o.device != "cpu" && !cuda)
        throw Misuse("--device: found '" + o.device + "', allowed: cpu, cuda, cuda:n");
}

// The program, its build and the features that it was built with or without, as configuring names them.
std::string version_text() {
    std::string text = "wetcurl";
    for (const auto& [name, fact] : provenance()) {
        if (name == "version") text += " " + fact;
        if (name == "version" || name == "gpu" || name == "date") continue;
        text += "\n" + name + ": " + fact;
    }
    return text + "\nfeatures: " WETCURL_FEATURES "\nleft out: " WETCURL_LEFT_OUT;
}

// `status`, or 1 where not all of standard output has arrived.
int flushed(int status) {
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return status;
    std::fprintf(stderr, "wetcurl: standard output: cannot be written (disk full, or a closed pipe)\n");
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    end_when_interrupted();
    std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write, and said
    CLI::App app{
        "wetcurl simulates wet curly hair, trains networks on what it simulates, and runs them in its "
        "place."};
    app.require_subcommand(1);
    app.set_version_flag("--version", version_text);
    Verbosity verbosity;
    std::function<int()> run;
    std::vector<std::string> known;
    auto add = [&]<class Options>(int (*command)(const Options&)) {
        auto options = std::make_shared<Options>();
        CLI::App& sub = *app.add_subcommand(Options::command, Options::summary);
        known.push_back(Options::command);
        OptionList list(sub);
        add_common(list, *options, verbosity);
        add_options(list, *options);
        sub.callback([&, options, command] {
            run = [&, options, command] {
                apply(verbosity, *options);
                if (!Options::reads_scene) refuse_scene_options(*options, Options::command);
                if (!Options::uses_device) refuse_device(*options, Options::command);
                return command(*options);
            };
        });
    };
    add(simulate_command);
    add(encode_command);
    add(dataset_command);
    add(train_command);
    add(retrain_command);
    add(infer_command);
    add(compare_command);
    add(report_command);
    add(render_command);
    add(plot_command);
    add(import_command);
    add(export_command);
    add(inspect_command);
    add(stability_command);
    add(bench_command);

    try {
        const std::string name = argc > 1 ? argv[1] : "-";
        if (name[0] != '-' && std::find(known.begin(), known.end(), name) == known.end())
            throw Misuse("found command '" + name + "', allowed: " + CLI::detail::join(known, ", ") +
                         did_you_mean(name, known));
        app.parse(argc, argv);
        return flushed(run());
    } catch (const CLI::ParseError& e) {
        const int status = app.exit(e);
        return status == 0 ? flushed(0) : 2;
    } catch (const Interrupted& e) {
        std::fprintf(stderr, "wetcurl: %s\n", e.what());
        return 130;
    } catch (const Misuse& e) {
        std::fprintf(stderr, "wetcurl: %s\n", e.what());
        return 2;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "wetcurl: out of memory\n");
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "wetcurl: %s\n", e.what());
        return 1;
    }
}
