// Data matrices by libdmtx (contrast/measure/matrix_code.h). No other source sees that library.
//
// libdmtx places codewords where modules are marked as assigned, and modules where they are not: its decoder takes an
// array of modules in the one direction, and the corrected codewords back to modules in the other.
#include "contrast/measure/matrix_code.h"

#include <dmtx.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "base/error.h"

namespace gonio::contrast {
namespace {

struct MessageDeleter {
  void operator()(DmtxMessage* message) const { dmtxMessageDestroy(&message); }
};
struct EncodeDeleter {
  void operator()(DmtxEncode* encode) const { dmtxEncodeDestroy(&encode); }
};
using Message = std::unique_ptr<DmtxMessage, MessageDeleter>;
using Encode = std::unique_ptr<DmtxEncode, EncodeDeleter>;

constexpr int sizes = DmtxSymbol16x48 + 1;

int attribute(DmtxSymAttribute which, int size) {
  return dmtxGetSymbolAttribute(which, size);
}

std::optional<int> size_of(int rows, int columns) {
  for (int size = 0; size < sizes; ++size)
    if (attribute(DmtxSymAttribSymbolRows, size) == rows && attribute(DmtxSymAttribSymbolCols, size) == columns)
      return size;
  return std::nullopt;
}

// Place of a module, rows from the top, in the mapping matrix of the data regions; nothing for the finder.
std::optional<std::size_t> mapping_place(int size, int row, int column) {
  const int high = attribute(DmtxSymAttribDataRegionRows, size), wide = attribute(DmtxSymAttribDataRegionCols, size);
  const int r = row % (high + 2), c = column % (wide + 2);
  if (r == 0 || r == high + 1 || c == 0 || c == wide + 1) return std::nullopt;
  const int mapped_row = row / (high + 2) * high + r - 1, mapped_column = column / (wide + 2) * wide + c - 1;
  return static_cast<std::size_t>(mapped_row * attribute(DmtxSymAttribMappingMatrixCols, size) + mapped_column);
}

// Solid lines at the left and the bottom of every region, clock tracks at its top and right.
std::uint8_t finder_bit(int size, int row, int column) {
  const int high = attribute(DmtxSymAttribDataRegionRows, size) + 2,
            wide = attribute(DmtxSymAttribDataRegionCols, size) + 2;
  const int r = row % high, c = column % wide;
  if (c == 0 || r == high - 1) return 1;
  return r == 0 ? c % 2 == 0 : r % 2 == 1;
}

template <class Data>
Bits symbol(int size, const Data& data) {
  Bits bits{attribute(DmtxSymAttribSymbolRows, size), attribute(DmtxSymAttribSymbolCols, size), {}};
  for (int row = 0; row < bits.rows; ++row)
    for (int column = 0; column < bits.columns; ++column) {
      const auto place = mapping_place(size, row, column);
      bits.bits.push_back(place ? data(*place) : finder_bit(size, row, column));
    }
  return bits;
}

// Decodes what `fill` puts into the message's arrays; nothing where that cannot be corrected.
template <class Fill>
Message decoded(int size, Fill fill) {
  DmtxMessage* message = dmtxMessageCreate(size, DmtxFormatMatrix);
  if (message == nullptr) throw Error(Exit::internal, "data matrix", "found no memory");
  std::memset(message->array, 0, message->arraySize);
  std::memset(message->code, 0, message->codeSize);
  fill(*message);
  return Message(dmtxDecodePopulatedArray(size, message, DmtxUndefined));  // destroys it where it fails
}

}  // namespace

bool matrix_size_exists(int rows, int columns) {
  return size_of(rows, columns).has_value();
}

std::string matrix_sizes() {
  std::string text;
  for (int size = 0; size < sizes; ++size)
    text += (size > 0 ? ", " : "") + std::to_string(attribute(DmtxSymAttribSymbolRows, size)) + "x" +
            std::to_string(attribute(DmtxSymAttribSymbolCols, size));
  return text;
}

std::optional<MatrixCode> read_matrix(const Bits& modules) {
  const auto size = size_of(modules.rows, modules.columns);
  if (!size) return std::nullopt;
  const Message message = decoded(*size, [&](DmtxMessage& m) {
    for (int row = 0; row < modules.rows; ++row)
      for (int column = 0; column < modules.columns; ++column)
        if (const auto place = mapping_place(*size, row, column))
          m.array[*place] = static_cast<unsigned char>(
              DmtxModuleAssigned |
              (modules.bits[static_cast<std::size_t>(row * modules.columns + column)] ? DmtxModuleOnRGB : 0));
  });
  if (!message) return std::nullopt;
  const Message corrected =
      decoded(*size, [&](DmtxMessage& m) { std::memcpy(m.code, message->code, message->codeSize); });
  if (!corrected) return std::nullopt;
  MatrixCode code;
  code.text.assign(reinterpret_cast<const char*>(message->output), static_cast<std::size_t>(message->outputIdx));
  code.modules = symbol(*size, [&](std::size_t place) {
    return static_cast<std::uint8_t>((corrected->array[place] & DmtxModuleOnRGB) != 0);
  });
  return code;
}

MatrixCode write_matrix(const std::string& text, int rows, int columns, const std::string& place) {
  const auto wanted = rows > 0 ? size_of(rows, columns) : std::optional<int>(DmtxSymbolSquareAuto);
  if (!wanted)
    throw Error(Exit::data, place,
                "has " + std::to_string(rows) + " x " + std::to_string(columns) + " cells, which no data matrix has",
                "data matrices are " + matrix_sizes());
  const Encode encode(dmtxEncodeCreate());
  std::string copy = text;
  dmtxEncodeSetProp(encode.get(), DmtxPropSizeRequest, *wanted);
  dmtxEncodeSetProp(encode.get(), DmtxPropScheme, DmtxSchemeAscii);
  if (text.empty() || dmtxEncodeDataMatrix(encode.get(), static_cast<int>(copy.size()),
                                           reinterpret_cast<unsigned char*>(copy.data())) == DmtxFail)
    throw Error(
        Exit::data, place,
        "says \"" + text + "\", which does not fit into " + std::to_string(rows) + " x " + std::to_string(columns),
        "give a shorter text or a larger data matrix");
  MatrixCode code{text, {}};
  code.modules = symbol(encode->region.sizeIdx, [&](std::size_t at) {
    return static_cast<std::uint8_t>((encode->message->array[at] & DmtxModuleOnRGB) != 0);
  });
  return code;
}

double finder_share(const Bits& modules) {
  const auto size = size_of(modules.rows, modules.columns);
  if (!size) return 0;
  int all = 0, right = 0;
  for (int row = 0; row < modules.rows; ++row)
    for (int column = 0; column < modules.columns; ++column) {
      if (mapping_place(*size, row, column)) continue;
      ++all;
      right += modules.bits[static_cast<std::size_t>(row * modules.columns + column)] == finder_bit(*size, row, column);
    }
  return static_cast<double>(right) / all;
}

}  // namespace gonio::contrast
