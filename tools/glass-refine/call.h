// glass-refine behind its description.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "cli/program.h"
#include "glass/refine/refine.h"
#include "io/image.h"

namespace gonio::tools::glass_refine {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

struct Rendered {         // the view that was kept out, with one of the bodies
  double difference = 0;  // answer.h, difference_from
  io::Image picture{};    // with Stokes planes; empty: was not asked for
};
// `maps`: of each view (answer.h, maps_of).
std::string page_of(const glass::Refined& refined, std::span<const glass::View> views, std::size_t held_out,
                    const std::vector<io::Image>& maps, const Rendered& hull, const Rendered& body);

}  // namespace gonio::tools::glass_refine
