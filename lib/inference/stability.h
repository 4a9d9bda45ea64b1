// How often an answer comes out where only a part of the recordings had been made: three quarters of the groups, drawn
// without putting back (Meinshausen & Buehlmann, Stability selection, JRSS B 72(4), 2010, with half of them there; few
// views leave no half). A name that hangs on two photographs is seen here.
#pragma once
#include <cstdint>
#include <functional>

#include "inference/explanation.h"

namespace gonio::inference {

// `explained` gives the answer where these groups (ascending) count as not recorded. Fewer draws than asked for where
// the groups have no more different parts; none below four groups. The draws depend on the seed alone.
Stability stability(const Problem& problem, std::size_t draws, std::uint64_t seed,
                    const std::function<Explanation(const std::vector<std::size_t>& left_out)>& explained);

// What is named, ascending, as Stability counts it.
std::vector<std::size_t> whatever_the_form(const Problem& problem, std::vector<std::size_t> named);

}  // namespace gonio::inference
