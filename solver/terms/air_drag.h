// Drag of moving air on hair: a force along the strand, in proportion to the slip between air and hair.
// The paper, Fig 32, gives no formula; this one is a slow cylinder's, ours.
#pragma once

#include "base/parameters.h"
#include "solver/terms/chain.h"

namespace wetcurl {

// The force on a length l of hair is c l (u - v), half of it on each end of an edge; implicit in v.
struct AirDrag {
    static constexpr const char *name = "air drag", *table = "air";
    static constexpr bool couples_two_edges = false;
    double c;
    static constexpr Parameter<AirDrag> parameters[] = {
        {KeyRow::number(
             "drag", "kg/(m s)", 1e-4, 0, 1e3,
             "Force for each metre of hair and each m/s between air and hair; hair 80 um across has "
             "0.8e-4 at 0.1 m/s and 2e-4 at 1 m/s.",
             "White 1991, C_d = 1 + 10 Re^(-2/3)"),
         &AirDrag::c},
    };

    template <class S>
    WETCURL_HD S energy(const ChainView<S>&) const {
        return S(0);
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& view, const ChainSystem<S>& a, int begin, int end) const {
        for (int last = begin > 1 ? begin : 1; last < end; ++last) {
            const S half = S(0.5 * c) * view.rest_length[last - 1];
            for (int i = last - 1; i <= last; ++i) {
                a.force(i) += half * (view.air[i] - view.v[i]);
                if (a.with_matrix()) add_identity(a.diagonal(i), a.h * half);
            }
        }
    }
};

}  // namespace wetcurl
