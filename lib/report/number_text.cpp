#include "report/number_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace gonio::report {
namespace {

std::string print(const char* format, int digits, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, digits, value);
  std::string out = text;
  for (std::size_t at = 0; (at = out.find('-', at)) != std::string::npos; at += 3)
    if (at == 0) out.replace(at, 1, "\u2212");
  return out;
}

bool plain(double value) {
  return value == 0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e6);
}

int decimals_for(double sigma) {
  const int place = static_cast<int>(std::floor(std::log10(sigma)));
  const bool two =
      sigma / std::pow(10.0, place) < 3;  // 1 or 2 in front: one digit alone would be rounded by up to a half
  return std::clamp(-place + (two ? 1 : 0), 0, 9);
}

}  // namespace

std::string number_text(double value, int significant) {
  if (!std::isfinite(value)) return "\u2013";
  if (!plain(value)) return print("%.*e", significant - 1, value);
  if (value == 0) return "0";
  const int decimals = std::max(0, significant - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  return print("%.*f", decimals, value);
}

std::string value_for_sigma(double value, double sigma) {
  if (!std::isfinite(value) || !(sigma > 0) || !std::isfinite(sigma) || !plain(value) || sigma < 1e-9)
    return number_text(value, 4);
  return print("%.*f", decimals_for(sigma), value);
}

std::string sigma_text(double value, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) return {};
  return "\u00b1 " +
         (plain(value) && sigma >= 1e-9 ? print("%.*f", decimals_for(sigma), sigma) : number_text(sigma, 2));
}

std::string with_sigma(double value, double sigma) {
  const std::string beside = sigma_text(value, sigma);
  return value_for_sigma(value, sigma) + (beside.empty() ? "" : " " + beside);
}

std::string percent_text(double share, int decimals) {
  return std::isfinite(share) ? print("%.*f", decimals, 100 * share) + " %" : "\u2013";
}

}  // namespace gonio::report
