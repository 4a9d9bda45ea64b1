// Vector drawings are one path of rectangles each, filled at once: a rasteriser then leaves no hairlines between cells
// that touch. PDF: ISO 32000-1, one page, no compression. PNG: io's encoder, plus the chunk pHYs that says how large a
// pixel is.
#include "camera/board_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "io/picture.h"

namespace gonio::camera {
namespace {

constexpr double least_margin_mm = 5, fit_margin_mm = 12, caption_mm = 3;
constexpr double mm_per_inch = 25.4, points_per_inch = 72;
constexpr double most_pixels = 4e8;

std::string caption_of(const Board& board) {
  const std::string square = format("square %.10g mm", 1e3 * board.square_m);
  if (board.kind == BoardKind::checkerboard) {
    return "checkerboard " + std::to_string(board.corner_columns) + "x" + std::to_string(board.corner_rows) +
           " inner corners, " + square + "; print at 100 %";
  }
  std::string layout;
  if (board.layout_matters()) layout = board.legacy.value_or(false) ? ", legacy layout" : ", current layout";
  return "charuco " + std::to_string(board.square_columns()) + "x" + std::to_string(board.square_rows()) +
         " squares, " + square + format(", marker %.10g mm, ", 1e3 * board.marker_m) + board.dictionary + layout +
         "; print at 100 %";
}

// Black areas in millimetres from the page's top left.
std::vector<Rectangle> areas_mm(const Board& board, const Drawing& drawing) {
  std::vector<Rectangle> areas = black_areas(board);
  const Vec2 origin = board.squares_origin_m();
  for (Rectangle& r : areas) {
    r = {(r.low_m - origin) * 1e3 + drawing.board_mm, (r.high_m - origin) * 1e3 + drawing.board_mm};
  }
  return areas;
}

Vec2 caption_place(const Board& board, const Drawing& drawing) {
  return {drawing.board_mm.x, drawing.board_mm.y + 1e3 * board.square_m * board.square_rows() + 1.4 * caption_mm};
}

std::uint32_t crc32(std::string_view bytes) {  // ISO 3309, as PNG chunks use it
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
  }
  return ~crc;
}

std::string big_endian(std::uint32_t v) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>((v >> shift) & 0xffu);
  return bytes;
}

// The file with a pHYs chunk behind its header chunk (8 bytes of signature, 25 of IHDR).
std::string with_resolution(const std::string& png, double dots_per_inch) {
  const std::string per_metre = big_endian(static_cast<std::uint32_t>(std::lround(1e3 * dots_per_inch / mm_per_inch)));
  const std::string body = "pHYs" + per_metre + per_metre + '\x01';
  return png.substr(0, 33) + big_endian(9) + body + big_endian(crc32(body)) + png.substr(33);
}

// Share of pixel i, which covers [i, i + 1), that lies between low and high.
double covered(int i, double low, double high) {
  return std::clamp(high - i, 0.0, 1.0) - std::clamp(low - i, 0.0, 1.0);
}

}  // namespace

const std::vector<Paper>& papers() {
  static const std::vector<Paper> list = {{"a0", 841, 1189},        {"a1", 594, 841}, {"a2", 420, 594},
                                          {"a3", 297, 420},         {"a4", 210, 297}, {"a5", 148, 210},
                                          {"letter", 215.9, 279.4}, {"fit", 0, 0}};
  return list;
}

std::vector<std::string> paper_names() {
  std::vector<std::string> names;
  for (const Paper& paper : papers()) names.emplace_back(paper.name);
  return names;
}

Drawing lay_out(const Board& board, std::string_view paper, const std::string& place) {
  const double width = 1e3 * board.square_m * board.square_columns(),
               height = 1e3 * board.square_m * board.square_rows();
  const auto found = std::ranges::find(papers(), paper, &Paper::name);
  if (found == papers().end()) throw Error(Exit::usage, place, "\"" + std::string(paper) + "\" is no paper", "use a4");
  Drawing drawing{found->width_mm, found->height_mm, {}, caption_of(board)};
  if (found->width_mm == 0) {
    drawing.width_mm = width + 2 * fit_margin_mm;
    drawing.height_mm = height + 2 * fit_margin_mm;
  } else if (width > height) {
    std::swap(drawing.width_mm, drawing.height_mm);
  }
  if (width + 2 * least_margin_mm > drawing.width_mm || height + 2 * least_margin_mm > drawing.height_mm) {
    throw Error(Exit::usage, place,
                format("a board of %.4g x %.4g mm", width, height) + " and margins of 5 mm do not fit on " +
                    std::string(paper) + format(" (%.4g x %.4g mm)", drawing.width_mm, drawing.height_mm),
                "take larger paper, or fit, or smaller squares");
  }
  drawing.board_mm = {0.5 * (drawing.width_mm - width), 0.5 * (drawing.height_mm - height)};
  return drawing;
}

std::string pdf_of(const Board& board, const Drawing& drawing) {
  const double scale = points_per_inch / mm_per_inch;
  std::string content = format("q %.9f 0 0 %.9f 0 %.6f cm\n", scale, -scale, scale * drawing.height_mm);
  for (const Rectangle& r : areas_mm(board, drawing)) {
    content += format("%.6f %.6f %.6f %.6f re\n", r.low_m.x, r.low_m.y, r.high_m.x - r.low_m.x, r.high_m.y - r.low_m.y);
  }
  const Vec2 at = caption_place(board, drawing);
  content +=
      "f\nQ\n" +
      format("BT /F1 %.3f Tf %.3f %.3f Td (", scale * caption_mm, scale * at.x, scale * (drawing.height_mm - at.y)) +
      drawing.caption + ") Tj ET\n";
  const std::array<std::string, 5> objects = {
      "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      "<< /Type /Page /Parent 2 0 R /Resources << /Font << /F1 5 0 R >> >> /Contents 4 0 R " +
          format("/MediaBox [0 0 %.6f %.6f] >>", scale * drawing.width_mm, scale * drawing.height_mm),
      "<< /Length " + std::to_string(content.size()) + " >>\nstream\n" + content + "endstream",
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
  std::string pdf = "%PDF-1.4\n";
  std::string table = "xref\n0 6\n0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += format("%010.0f 00000 n \n", static_cast<double>(pdf.size()));
    pdf += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::size_t start = pdf.size();
  return pdf + table + "trailer\n<< /Size 6 /Root 1 0 R >>\nstartxref\n" + std::to_string(start) + "\n%%EOF\n";
}

std::string svg_of(const Board& board, const Drawing& drawing) {
  std::string svg = format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.6fmm\" height=\"%.6fmm\" viewBox=\"0 0 %.6f %.6f\">\n",
      drawing.width_mm, drawing.height_mm, drawing.width_mm, drawing.height_mm);
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<path fill=\"black\" d=\"";
  for (const Rectangle& r : areas_mm(board, drawing)) {
    svg += format("M%.6f %.6fH%.6fV%.6f", r.low_m.x, r.low_m.y, r.high_m.x, r.high_m.y) + format("H%.6fz\n", r.low_m.x);
  }
  const Vec2 at = caption_place(board, drawing);
  svg += "\"/>\n" + format("<text x=\"%.3f\" y=\"%.3f\" font-family=\"Helvetica,Arial,sans-serif\" font-size=\"%.3f\">",
                           at.x, at.y, caption_mm);
  return svg + drawing.caption + "</text>\n</svg>\n";
}

std::string png_of(const Board& board, const Drawing& drawing, double dots_per_inch, const std::string& place) {
  const double scale = dots_per_inch / mm_per_inch;
  const double columns = std::round(scale * drawing.width_mm), rows = std::round(scale * drawing.height_mm);
  if (!(columns * rows <= most_pixels)) {
    throw Error(Exit::usage, place, format("%.0f x %.0f pixels (limit 400 million)", columns, rows), "lower --dpi");
  }
  io::Image image(static_cast<int>(columns), static_cast<int>(rows), {"Y"});
  std::ranges::fill(image.data, 1.0F);
  for (const Rectangle& r : areas_mm(board, drawing)) {
    const Vec2 low = r.low_m * scale, high = r.high_m * scale;
    for (int y = static_cast<int>(low.y); y < std::min<double>(rows, high.y); ++y) {
      const double share = covered(y, low.y, high.y);
      for (int x = static_cast<int>(low.x); x < std::min<double>(columns, high.x); ++x) {
        image.at(x, y, 0) -= static_cast<float>(share * covered(x, low.x, high.x));
      }
    }
  }
  return with_resolution(io::encode_png(image), dots_per_inch);
}

void check_drawing_name(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".pdf" || extension == ".svg" || extension == ".png") return;
  throw Error(Exit::usage, "--draw", "\"" + path.string() + "\" ends in none of .pdf, .svg, .png", "rename it");
}

void draw_board(const Board& board, const std::filesystem::path& path, std::string_view paper, double dots_per_inch) {
  check_drawing_name(path);
  const Drawing drawing = lay_out(board, paper, "--paper");
  const std::string extension = path.extension().string();
  write_file(path, extension == ".pdf"   ? pdf_of(board, drawing)
                   : extension == ".svg" ? svg_of(board, drawing)
                                         : png_of(board, drawing, dots_per_inch, "--dpi"));
}

}  // namespace gonio::camera
