// A sensor's figures as a page and as a table.
#pragma once
#include <string>

#include "photograph/characterize.h"

namespace gonio::tools::develop {

std::string sensor_page(const photograph::SensorFigures& figures);
std::string sensor_csv(const photograph::SensorFigures& figures);  // plane,figure,unit,value,sigma,lower,upper

}  // namespace gonio::tools::develop
