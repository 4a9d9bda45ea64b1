// What became of views, as a page: figures of each pair, how residuals spread, where they lie, and how views moved.
#pragma once
#include <string>
#include <vector>

#include "mesh/register.h"

namespace gonio::mesh {

std::string register_page(const MeasuredPoints& points, const Registration& found,
                          const std::vector<std::string>& names, const RegisterWish& wish);

}  // namespace gonio::mesh
