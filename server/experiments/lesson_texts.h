// Lesson texts: what is made of lessons for people: handouts to print, and tables of the answers in run files.
//
// Threads      none.
#pragma once

#include "server/experiments/lesson_file.h"

#include <ostream>
#include <string>

namespace evod::experiments {

/// Returns a lesson as an HTML page to print, with space for the predictions.
///
/// language  "en" or "de": of the words that are not in the lesson.
std::string handout_of(const Lesson& lesson, const std::string& language);

/// Writes the first line of the table of answers.
void write_report_heading(std::ostream& out);
/// Writes one line for each prediction that the notes of a run contain, in their order. Notes that do not have the form
/// of docs/LESSONS.md are left out.
base::Result<void> write_report(const std::string& path, std::ostream& out);

} // namespace evod::experiments
