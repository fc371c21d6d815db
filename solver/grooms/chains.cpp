// Chains of edges.
#include "solver/grooms/chains.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.h"

namespace wetcurl {

std::vector<std::vector<size_t>> chains_of(const std::vector<std::array<size_t, 2>>& edges, size_t vertices,
                                           const std::string& path) {
    constexpr size_t none = std::numeric_limits<size_t>::max();
    // (vertex): those it is joined to, and whether an edge leads to it.
    std::vector<std::array<size_t, 2>> joined(vertices, {none, none});
    std::vector<bool> is_entered(vertices, false);
    for (size_t e = 0; e < edges.size(); ++e) {
        const auto [from, to] = edges[e];
        for (size_t vertex : {from, to})
            if (vertex >= vertices)
                throw Error(path + ": edge " + std::to_string(e) + ": found vertex " +
                            std::to_string(vertex) + ", allowed 0 up to " + std::to_string(vertices) +
                            ", not included");
        if (from == to)
            throw Error(path + ": edge " + std::to_string(e) + ": found vertex " + std::to_string(from) +
                        " joined to itself, allowed are two vertices");
        for (const auto& [a, b] : {std::pair{from, to}, {to, from}}) {
            auto& ends = joined[a];
            if (ends[0] == b || ends[1] == b)
                throw Error(path + ": edge " + std::to_string(e) + ": found vertices " + std::to_string(a) +
                            " and " + std::to_string(b) + " joined twice, allowed is once");
            if (ends[1] != none)
                throw Error(path + ": vertex " + std::to_string(a) +
                            ": found three edges or more, allowed are two: strands do not branch");
            (ends[0] == none ? ends[0] : ends[1]) = b;
        }
        is_entered[to] = true;
    }

    std::vector<std::vector<size_t>> chains;
    std::vector<bool> is_taken(vertices, false);
    // From `vertex`, one of a chain's ends, to the other.
    auto walk = [&](size_t vertex) {
        std::vector<size_t> chain;
        for (size_t before = none; vertex != none;) {
            chain.push_back(vertex);
            is_taken[vertex] = true;
            const auto [a, b] = joined[vertex];
            const size_t next = a != before ? a : b;
            before = vertex;
            vertex = next;
        }
        return chain;
    };
    for (size_t vertex = 0; vertex < vertices; ++vertex) {
        if (is_taken[vertex] || joined[vertex][1] != none) continue;
        std::vector<size_t> chain = walk(vertex);
        if (is_entered[vertex] && !is_entered[chain.back()]) std::reverse(chain.begin(), chain.end());
        chains.push_back(std::move(chain));
    }
    const auto closed = std::find(is_taken.begin(), is_taken.end(), false);
    if (closed != is_taken.end())
        throw Error(path + ": vertex " + std::to_string(closed - is_taken.begin()) +
                    ": found edges that lead in a circle, allowed are strands with two ends");
    std::vector<std::pair<size_t, size_t>> order;  // lowest vertex, chain
    for (size_t k = 0; k < chains.size(); ++k)
        order.emplace_back(*std::min_element(chains[k].begin(), chains[k].end()), k);
    std::sort(order.begin(), order.end());
    std::vector<std::vector<size_t>> sorted;
    for (const auto& [lowest, k] : order) sorted.push_back(std::move(chains[k]));
    return sorted;
}

}  // namespace wetcurl
