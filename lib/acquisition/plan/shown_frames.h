// Views at which a screen or projector shows a projection: a step for every frame, all of them one `group`.
#pragma once
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {

struct ShownProjection {
  std::string screen, projection;  // names in laboratory/screens and in projections
};
// "beamer=gray", or "gray" where the laboratory has one screen. Error(usage) at `place` for names that there are not;
// Error(data) for a screen of another size than the projection, and for frames that have no picture.
ShownProjection shown_projection(const std::string& text, const std::string& place, const manifest::Document& document);

// Steps that stand for views, each repeated for every frame: VIEW-000, VIEW-001, ... Those of purposes that a run comes
// back to (reference, and board where `boards_come_back`) stay single. Error(usage) for a bracket of exposures: which
// of its pictures would be the frame?
std::vector<manifest::PlanStep> with_frames(const std::vector<manifest::PlanStep>& steps, const ShownProjection& shown,
                                            bool boards_come_back, const manifest::Document& document);

}  // namespace gonio::acquisition
