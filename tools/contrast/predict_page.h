// Pages of `contrast predict`: mean contrasts in the layout of Luongo et al. 2017, figure 8, and every combination.
#pragma once
#include <string>

#include "contrast/predict/predict.h"
#include "report/page.h"

namespace gonio::tools::contrast {

// Plots of the means: tilt, the varied parameters, rotation, side by side.
std::vector<report::Plot> mean_plots(const gonio::contrast::Prediction& prediction);
// Means, every combination, and how they were found: sections of a page.
void add_prediction(report::Page& page, const gonio::contrast::Prediction& prediction);
std::string predict_page(const gonio::contrast::Prediction& prediction);

}  // namespace gonio::tools::contrast
