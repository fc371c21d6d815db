// Runs, or for adhesion scenes, to what training reads.
#include "app/dataset/encode_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/engine/learned_hair.h"
#include "app/engine/run_of_scene.h"
#include "app/engine/simulated_frames.h"
#include "app/files/results.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "learn/codec/encode_runs.h"
#include "solver/scene/rest_state.h"

namespace wetcurl {

namespace {

void record_input(PairsWriter& out, size_t run, const std::string& role, const std::string& path) {
    out.attribute(fmt::format("input {:03d} {}", run, role), path + " " + hash_of_file(path));
}

std::string low_of(const RunPair& pair) { return simulated_wet(pair.dry->header()) ? "wet" : "dry"; }

// The fewest of all.
int low_substeps_of(const std::vector<RunPair>& pairs) {
    int fewest = substeps_of(pairs[0].dry->header());
    for (const RunPair& pair : pairs) fewest = std::min(fewest, substeps_of(pair.dry->header()));
    return fewest;
}

std::vector<RunPair> open_pairs(const std::vector<std::string>& inputs) {
    if (inputs.empty() || inputs.size() % 2)
        throw Misuse(fmt::format(
            "encode: found {} runs, allowed are pairs: DRY.h5 WET.h5 [DRY.h5 WET.h5 ...]", inputs.size()));
    std::vector<RunPair> out;
    for (size_t k = 0; k < inputs.size(); k += 2) out.emplace_back(inputs[k], inputs[k + 1]);
    for (const auto& pair : out) {
        if (low_of(pair) != low_of(out[0]))
            throw Error(fmt::format("{}: was simulated {}, {} {}; allowed are runs of one kind",
                                    pair.dry->path(), low_of(pair), out[0].dry->path(), low_of(out[0])));
        const int found = pair.wet->header().groom.rest.particles,
                  allowed = out[0].wet->header().groom.rest.particles;
        if (found != allowed)
            throw Error(fmt::format("{}: found {} particles a strand, allowed {} (as {} has it)",
                                    pair.wet->path(), found, allowed, out[0].wet->path()));
    }
    return out;
}

// The strands of a run at rest with their water.
Strands shape_of(const RunHeader& header) {
    const bool curls =
        Config::parse(header.scene, scene_name(header), header.scene_folder).root().table("curl").present();
    if (!curls) return header.groom.rest;
    return shape_at_rest(*scene_of_run(header));
}

Json encode_pairs(const PairsRequest& o, Codec codec) {
    refuse_scene_options(o, "encode of runs");
    const auto pairs = open_pairs(o.inputs);
    PairsWriter out(o.output, codec, pairs[0].wet->header().groom.rest.particles, o.overwrite);
    out.low(low_of(pairs[0]) == "wet", low_substeps_of(pairs));
    if (low_of(pairs[0]) == "wet")
        log_warning(pairs[0].dry->path() +
                    ": was simulated wet; a model of these pairs is for wet runs only");
    Json json{{"codec", o.codec}, {"runs", pairs.size()}};
    if (codec == Codec::strand) {
        double floor_mm = 0;
        for (const auto& pair : pairs) {
            const Strands shape = shape_of(pair.wet->header());
            const RunHeader& low = pair.dry->header();
            const HairTraits traits =
                traits_of(*scene_of_run(pair.wet->header()), 1 / (low.fps * substeps_of(low)));
            floor_mm += encode_strands(pair, out, &shape, traits) / double(pairs.size());
        }
        out.attribute("floor_mm", floor_mm);
        json["floor_mm"] = floor_mm;
        log_info(fmt::format("{}: encoding alone costs {:.2f} mm on average", o.output, floor_mm));
    } else {
        const float radius = support_radius_of(pairs[0].wet->header());
        for (const auto& pair : pairs)
            if (support_radius_of(pair.wet->header()) != radius)
                throw Error(pair.wet->path() + ": its cohesion radius is not that of " +
                            pairs[0].wet->path() + ", allowed one for all");
        encode_roots(pairs, radius, out,
                     o.colour_units.empty() ? ShiftUnits::length : shift_units_named(o.colour_units));
    }
    int frames = 0;
    for (size_t k = 0; k < pairs.size(); ++k) {
        frames += pairs[k].dry->frames();
        record_input(out, k, "dry", pairs[k].dry->path());
        record_input(out, k, "wet", pairs[k].wet->path());
    }
    json["frames"] = frames;
    out.commit();
    return json;
}

std::vector<AdhesionSample> samples_of(const std::vector<AdhesionRecord>& records) {
    std::vector<AdhesionSample> out;
    for (const auto& record : records) {
        AdhesionSample& sample = out.emplace_back();
        std::copy_n(record.inputs, adhesion_inputs, sample.input.begin());
        sample.target = record.target;
        sample.contact = record.contact;
    }
    return out;
}

// Simulates each scene and keeps what Eq 11 answered near its solids, one group a frame that has some.
Json encode_adhesion(const PairsRequest& o) {
    std::vector<Scene> scenes;
    for (const auto& path : o.inputs) {
        SceneOptions options;
        options.set = o.set;
        options.seed = o.seed;
        scenes.push_back(scene_of_file(path, options));
        check_files(o, o.output, scenes.back().files);
        if (!scenes.back().term<Adhesion>())
            throw Misuse(path + ": has no [adhesion], which is what is to be learned");
    }
    PairsWriter out(o.output, Codec::adhesion, scenes.at(0).groom.rest.particles, o.overwrite);
    size_t samples = 0, contacts = 0;
    InterruptGuard guard;
    for (size_t k = 0; k < scenes.size(); ++k) {
        const auto simulation = make_simulation(scenes[k], "float");
        std::vector<AdhesionRecord> records;
        simulation->record_adhesion(&records);
        SimulatedFrames source(*simulation, scenes[k].frames);
        FrameDelivery frames({.what = "encode",
                              .frames = scenes[k].frames,
                              .note = [&] { return fmt::format("{} samples", samples); }},
                             guard);
        try {
            frames.run(source, [&](int, const RunFrame&) {
                const auto found = samples_of(records);
                records.clear();
                samples += found.size();
                for (const auto& sample : found) contacts += sample.contact;
                if (!found.empty()) out.add(found);
            });
        } catch (const Diverged& e) {
            throw Error(o.inputs[k] + ": " + e.what());
        }
        if (!frames.is_whole())
            throw Interrupted(fmt::format("interrupted at frame {} of {}", frames.delivered(), o.inputs[k]));
        record_input(out, k, "scene", o.inputs[k]);
    }
    if (samples == 0)
        throw Error(o.output + ": no particle came near a solid, so there is nothing to learn from");
    out.commit();
    log_info(fmt::format("{}: {} samples, {} of them in contact", o.output, samples, contacts));
    return {{"codec", o.codec}, {"scenes", scenes.size()}, {"samples", samples}, {"in_contact", contacts}};
}

// What is kept of an interrupted encoding: NAME.partial where it holds something (codec root sees all frames
// before it writes one).
std::string kept_of(const PairsRequest& o) {
    const std::string partial = partial_of(o.output);
    if (!H5Reader(partial, pairs_format, pairs_version).list("runs").empty())
        return "; what was encoded is kept in " + partial;
    std::filesystem::remove(partial);
    return "; nothing was encoded yet";
}

}  // namespace

void encode_pairs(const PairsRequest& o) {
    check_files(o, o.output, o.inputs);
    const Codec codec = codec_named(o.codec);
    if (codec != Codec::root && !o.colour_units.empty())
        throw Misuse("--colour-units is for --codec root, found --codec " + o.codec);
    ResultFile results(o);
    try {
        results.write_json(codec == Codec::adhesion ? encode_adhesion(o) : encode_pairs(o, codec));
    } catch (const Interrupted& e) {
        throw Interrupted(e.what() + kept_of(o));
    }
}

}  // namespace wetcurl
