// Numbers as people read them: a stated number of digits, no noise digits beyond the standard error.
#pragma once
#include <string>

namespace gonio::report {

std::string number_text(double value, int significant);   // "0.03118", "1.2e-07"; NaN is an en dash
std::string with_sigma(double value, double sigma);       // "1.0203 \u00b1 0.0004": sigma to two digits at most
std::string value_for_sigma(double value, double sigma);  // "1.0203": the digits that the sigma leaves
std::string sigma_text(double value, double sigma);       // "\u00b1 0.0004"
std::string percent_text(double share, int decimals);     // "0.27 %"

}  // namespace gonio::report
