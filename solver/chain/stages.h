// The order of one substep of strands, written once for all devices: a sequence of named stages. The bodies
// are those of whatever holds the strands: BlockStages (solver/chain/substep.h) for a block of strands,
// StrandStep (cuda/chain/strand_step.h) for a team of threads.
#pragma once

#include "solver/solids/contact.h"
#include "solver/terms/strain_limit.h"

namespace wetcurl {

// A stage is a type, its members are what the order tells the body. `take` of several stages is one pass: of
// one particle or edge, a stage reads nothing of the others that an earlier stage of the pass writes. So a
// team walks along the strand once for all of them.
namespace stage {

// Positions and velocities at which forces are taken: where particles are expected.
struct Predict {
    static constexpr const char* name = "predict";
};
// Which surfaces hold particles there.
struct FindHolds {
    static constexpr const char* name = "find holds";
};
// Frames to where forces are taken. `begins`: with the root's own rotation over the substep.
struct CarryFrames {
    static constexpr const char* name = "carry frames";
    bool begins;
};
// The strain limit is linearised at the edges there.
struct PlaceLimit {
    static constexpr const char* name = "place limit";
};
// Turns of edges about themselves.
struct RelaxTwist {
    static constexpr const char* name = "relax twist";
};
// What terms compute of the whole strand before their elements: the core's forces.
struct Prepare {
    static constexpr const char* name = "prepare";
};
// The surfaces that adhesion sees.
struct SampleSurfaces {
    static constexpr const char* name = "sample surfaces";
};
// Forces and matrix of all terms, and the solution of the system.
struct Solve {
    static constexpr const char* name = "solve";
};
// The strain limit is linearised where the solution has led edges, and surfaces hold other particles than
// expected: of those that they push, and, if `entering`, of those that the solution alone leads into them.
// `solves`: so often has the system been solved. Returns whether it must be solved again.
struct MoveLimit {
    static constexpr const char* name = "move limit";
    int solves;
    WETCURL_HD bool may_move() const { return solves < StrainLimit::most_solves; }
};
struct MoveHolds {
    static constexpr const char* name = "move holds";
    int solves;
    WETCURL_HD bool may_move(bool entering) const {
        return solves < (entering ? most_entering_solves : most_contact_solves);
    }
};
// Forces are taken anew where the solution has led strands of which an edge turned far. `linearisations`: so
// often have they been taken. Returns whether there is such a strand.
struct Relinearise {
    static constexpr const char* name = "relinearise";
    int linearisations;
};
// The new state, and the momentum that surfaces gave.
struct Place {
    static constexpr const char* name = "place";
};
// Particles that lie inside solids are moved out.
struct MeetSolids {
    static constexpr const char* name = "meet solids";
};
// The contact flags of adhesion.
struct UpdateTouching {
    static constexpr const char* name = "update touching";
};
// Frames to where the substep ends.
struct EndFrames {
    static constexpr const char* name = "end frames";
};

// Of the explicit substep alone. New velocities by the forces, then positions.
struct Push {
    static constexpr const char* name = "push";
};
// The limit of Iben 2013 on velocities along a strand.
struct LimitVelocities {
    static constexpr const char* name = "limit velocities";
};
// The strain limit of Selle 2008.
struct LimitStrain {
    static constexpr const char* name = "limit strain";
};

}  // namespace stage

// The step of solver/chain/chain_step.h, linearised again where an edge turns far from where its forces were
// taken.
template <class Strands>
WETCURL_HD void take_implicit_substep(Strands& strands) {
    using namespace stage;
    strands.take(Predict(), FindHolds());
    for (int linearisations = 1;; ++linearisations) {
        strands.take(CarryFrames{linearisations == 1}, PlaceLimit());
        strands.take(RelaxTwist(), Prepare());
        strands.take(SampleSurfaces());
        for (int solves = 1;; ++solves) {
            strands.take(Solve());
            if (!strands.take(MoveLimit{solves}, MoveHolds{solves})) break;
        }
        if (!strands.take(Relinearise{linearisations})) break;
    }
    strands.take(Place(), MeetSolids(), UpdateTouching());
    strands.take(EndFrames());
}

// The paper's scheme: symplectic Euler on printed forces, at the positions before.
template <class Strands>
WETCURL_HD void take_explicit_substep(Strands& strands) {
    using namespace stage;
    strands.take(RelaxTwist(), Prepare());
    strands.take(SampleSurfaces());
    strands.take(Push());
    strands.take(LimitVelocities());
    strands.take(LimitStrain());
    strands.take(MeetSolids(), UpdateTouching());
    strands.take(EndFrames());
}

}  // namespace wetcurl
