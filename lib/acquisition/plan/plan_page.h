// Pages of a laboratory and of a plan: the laboratory in three dimensions, the plan carried out in it at any time,
// joints, singular values and clearances over that time, and the views that cannot be reached.
#pragma once
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/plan/plan_model.h"
#include "manifest/sections/forward.h"
#include "report/page.h"

namespace gonio::acquisition {

// HTML in one file each. The plan belongs to this laboratory (planner.h: way_to).
std::string laboratory_page(const manifest::Document& document, const Laboratory& laboratory);
std::string plan_page(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan);

// Parts of them, for the page of a run (run/run_page.h).
struct PlanDrawing {  // what stays the same while a plan is carried out
  PlanTimes times;
  std::vector<report::Plot> limits, joints;  // over time
};
PlanDrawing drawing_of(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan);
void show_model(report::Page& page, io::MovingModel model, double start_s, const std::string& caption);
void show_over_time(report::Page& page, const PlanDrawing& drawing);
void list_unreachable(report::Page& page, const manifest::Plan& plan);

}  // namespace gonio::acquisition
