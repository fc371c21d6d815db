// The links between strands on the CPU, and their forces in a substep. A strand's links are computed by one
// thread, a vector's lanes at once, and what they do to another strand is added up by that one's, in the
// links' order: the result is the same for any number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "base/carried.h"
#include "base/geometry/neighbor_list.h"
#include "base/pack_rows.h"
#include "base/strands.h"
#include "solver/strand_contact/link_search.h"

namespace wetcurl {

class StrandLinks {
  public:
    // `drawn`: strands as drawn, which must outlive the links, with edges of so many metres at most.
    StrandLinks(const StrandContact& term, const Strands& drawn, double longest_edge);

    // (strand, particle), as they are expected at the end of the substep.
    std::vector<LinkedParticle> particles;
    // Links to what is near.
    void find();
    // Their forces over a step of dt [s], which leaves slip behind.
    void evaluate(double dt);
    // (strand, particle) [N], and what of its slopes goes on the diagonal [N/m].
    const std::vector<Vec3f>& force() const { return force_; }
    const std::vector<float>& stiffness() const { return diagonal_; }
    double potential(const std::vector<Vec3d>& at) const;  // [J], particles there

    double neighbours_mean() const {
        return double(on_other_.size()) / double(count_of_.size());
    }  // of a place
    const StrandPlaces& places() const { return places_; }
    const std::vector<StrandLink>& links() const { return links_; }  // (strand, place, link)
    void save(Carried& to) const;
    void resume(const Carried& from);
    size_t bytes() const;

  private:
    // What a link does to the other strand.
    struct OnOther {
        PlaceOnStrand place;
        FourFloatsAnywhere acts;
    };
    struct AtPlace;
    struct Lanes;
    void link_cluster(const LinkSearch& search, size_t cluster);
    void list_by_other();
    void act_on_own(uint32_t strand, const StrandContact::Step& step);
    void act_on_other(uint32_t strand);
    void add(const PlaceOnStrand& place, FourFloats acts);

    const StrandContact term_;
    const Strands& drawn_;
    const StrandPlaces places_;
    const float reach_, listed_;         // [m] in which neighbours are looked for, and are listed
    std::vector<PlaceOnStrand> place_;   // (strand, place)
    std::vector<LinkedParticle> there_;  // the same: what is seen there
    NeighborGrid grid_, wide_grid_;      // of what lists hold, and of the whole reach
    NeighborList near_;
    std::vector<Vec3f> x_;
    std::vector<float> any_;                // ones
    std::vector<StrandLink> links_, made_;  // (strand, place, link)
    std::vector<uint8_t> count_of_;         // (strand, place)
    // What links do, in the order of the strands that they lead to, and of the links.
    std::vector<OnOther> on_other_;
    std::vector<uint32_t> begin_;  // (strand + 1) in on_other_
    std::vector<uint32_t> slot_;   // (link that there is) in on_other_
    std::vector<uint32_t> first_;  // (strand) of the links that there are
    std::vector<uint32_t> next_;   // (strand) while links are listed
    std::vector<FourFloats> sum_;  // (strand, particle) force [N] and stiffness [N/m]
    std::vector<Vec3f> force_;
    std::vector<float> diagonal_;
};

}  // namespace wetcurl
