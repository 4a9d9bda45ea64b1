// The parts of the report page. Private to the report.
#pragma once
#include "inference/report.h"
#include "report/page.h"

namespace gonio::inference {

void tell_misplaced(report::Page& page, const ReportPart& part);  // files of other pictures; nothing without any
void tell_where(report::Page& page, const ReportPart& part);      // pictures, shares of the groups
void tell_curve(report::Page& page, const ReportPart& part);      // residuals over the telling conditions
void tell_law(report::Page& page, const ReportPart& part);   // what is outside the library; nothing where there is none
void tell_sure(report::Page& page, const ReportPart& part);  // verdict, scores, intervals, equals
void tell_next(report::Page& page, const ReportPart& part);  // what to measure
void tell_rest(report::Page& page, const ReportPart& part);  // folded: everything that was weighed

}  // namespace gonio::inference
