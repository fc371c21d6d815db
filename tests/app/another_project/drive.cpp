// What libwetcurl promises of simulations: drive SCENE.toml, of a scene that is wet and has a head. Ends with
// status 1 where a promise is broken; prints what was refused.
#include <cmath>
#include <cstdio>
#include <thread>
#include <wetcurl/wetcurl.hpp>

#include "promises.h"

namespace {

wetcurl::PoseArray turned(double angle) { return {0, 0, 0, std::cos(angle / 2), 0, std::sin(angle / 2), 0}; }

std::vector<float> after_a_turn(const wetcurl::Setup& setup, int threads) {
    wetcurl::Simulation hair(setup, "cpu", "float", threads);
    for (int frame = 1; frame <= 6; ++frame) hair.move_head(turned(0.05 * frame)), hair.advance(1 / 30.0);
    return hair.displayed();
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 2) return std::fprintf(stderr, "use: drive SCENE.toml\n"), 2;
    wetcurl::Setup setup = wetcurl::Setup::file(argv[1]);
    setup.set("integrator.settle=0");

    // Several at once, in threads of their own, are what each is alone.
    const std::vector<float> alone = after_a_turn(setup, 1);
    std::vector<float> of_threads[3];
    std::vector<std::thread> threads;
    for (auto& out : of_threads) threads.emplace_back([&] { out = after_a_turn(setup, 1); });
    for (auto& thread : threads) thread.join();
    for (const auto& out : of_threads) require(out == alone, "threads do not see each other");

    wetcurl::Simulation hair(setup);
    const std::vector<float> first = hair.displayed();
    hair.move_head(turned(0.3));
    hair.advance(0);
    require(hair.displayed() == first && hair.time() == 0, "nothing happens in a pause");
    hair.advance(0.04);
    require(hair.displayed() != first && std::abs(hair.time() - 0.04) < 1e-12, "a frame has its length");

    require_refused([&] { hair.move_solid("teapot", turned(0)); });
    require_refused(
        [&] { hair.move_roots(std::vector<wetcurl::PoseArray>(size_t(hair.strands()), turned(0))); });
    require_refused([&] { hair.advance(-1); });
    require_refused([&] { hair.advance(NAN); });
    require_refused([&] { hair.wet(hair.saturation()); });
    require_refused([&] { setup.mesh("head", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 7}); });
    require_refused([&] { wetcurl::Simulation(wetcurl::Setup::text("[groom]\nteapot = 7")); });
    require_refused([&] {
        setup.strands({2, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0}), wetcurl::Simulation{setup};
    });
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
