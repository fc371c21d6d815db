// The links between strands on the CPU, and their forces in a substep. A strand's links are computed by one
// thread, and what they do to another strand is added up by that one's, in the links' order: the result is
// the same for any number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "base/carried.h"
#include "base/geometry/neighbor_list.h"
#include "base/strands.h"
#include "solver/strand_contact/link_search.h"

namespace wetcurl {

class StrandLinks {
  public:
    // `drawn`: strands as drawn, which must outlive the links, with edges of so many metres at most.
    StrandLinks(const StrandContact& term, const Strands& drawn, double longest_edge);

    // (strand, particle): where they are expected at the end of the substep [m], how fast they are [m/s].
    std::vector<Vec3f> x, v;
    // (strand, particle) [kg], and saturation.
    std::vector<float> mass, saturation;
    // Links to what is near x.
    void find();
    // Their forces over a step of dt [s], which leaves slip behind.
    void evaluate(double dt);
    // (strand, particle) [N], and what of its slopes goes on the diagonal [N/m].
    const std::vector<Vec3f>& force() const { return force_; }
    const std::vector<float>& stiffness() const { return diagonal_; }
    // Whether links are so stiff that the step's end is corrected: `v` is by how much speeds changed in it
    // (strand, particle) [m/s], and becomes by how much they change beside that.
    bool corrects() const { return stiffest_ > StrandContact::least_stiff; }
    void correct(double dt);
    double potential(const std::vector<Vec3d>& at) const;  // [J], particles there

    double neighbours_mean() const { return double(count_) / double(count_of_.size()); }  // links of a place
    const StrandPlaces& places() const { return places_; }
    const std::vector<StrandLink>& links() const { return links_; }  // (strand, particle, place, link)
    void save(Carried& to) const;
    void resume(const Carried& from);
    size_t bytes() const;

  private:
    void list_by_other();
    void act_on_own(uint32_t strand, const StrandContact::Step& step);
    void act_on_other(uint32_t strand, bool with_stiffness);
    void add(const PlaceOnStrand& place, const Vec3f& force, float stiffness);
    template <class Visit>
    void for_each_link(uint32_t strand, Visit visit);

    const StrandContact term_;
    const Strands& drawn_;
    const StrandPlaces places_;
    const float reach_;
    NeighborGrid grid_;
    NeighborList near_;
    std::vector<float> any_;                // ones
    std::vector<StrandLink> links_, made_;  // (strand, particle, place, link)
    std::vector<uint8_t> count_of_;         // (strand, particle, place)
    size_t count_ = 0;
    // What links do, in the order of the strands that they lead to, and of the links.
    std::vector<LinkedStrands::Acting> on_other_;
    std::vector<uint32_t> begin_;  // (strand + 1) in on_other_
    std::vector<uint32_t> slot_;   // (link that there is) in on_other_
    std::vector<uint32_t> first_;  // (strand) in slot_
    std::vector<uint32_t> next_;   // (strand) while links are listed
    std::vector<Vec3f> force_;
    std::vector<float> stiffness_, diagonal_;
    float stiffest_ = 0;
};

}  // namespace wetcurl
