// Event text: the English sentences of events, made from the templates in proto/texts/events.json.
//
// The file is one JSON object. The template of an event has the name of its field in the oneof Event.kind. The server
// fills Event.text with it; the browser page reads the same file (client/web, event_text.ts). proto/vectors/events.json
// contains an example of each kind and variant, which the tests of both readers compare. A template consists of:
//   text
//   {PATH} or {PATH:RULE}   a value of the event, as text
//   [A|B]                   the first alternative whose values are all present; nothing if there is none
//   {P:R; P:R}              several values, of which those that are present are joined by ", "
// A path contains names of fields, beginning with the message of the kind, or with "event" for the Event itself. If a
// field is repeated, the path names all its values. The rules, and the texts of several values:
//   none             whole number with separators: 12,345; joined by ", "
//   first            the same for the first value
//   text             text, flag ("true"), or whole number without separators; joined by ", "
//   real             the shortest text that parses back; with an exponent below 1e-5 and from 1e15: 0.15, 1e-06
//   max, mean        number of all values with one decimal, ties away from 0; from 1e15 as real
//   sum, count       sum of all values, or number of values, as a whole number with separators
//   sum one/many     the same, and the word in the singular or plural: 1 organism, 2 organisms; absent if it is 0
//   count one/many
//   if               no text: only decides about an alternative
//   NAME             a template of this name, filled from each message of the path, joined by ", "; or a table of words
//                    of this name, which contains a text for each enumerator
// A number and a flag are present if the field is. Other values are present if their text is not empty. An absent
// message has no text; an absent number is 0.
//
// Threads      any; the templates are constant.
#pragma once

#include "evod/v1/stream.pb.h"

#include <string>

namespace evod::protocol {

/// Returns the sentence, without a full stop. The event must have a kind.
std::string event_text(const v1::Event& event);

/// Returns the sentence about the state of the disk; empty if there is no problem.
std::string storage_text(const v1::Storage& storage);

/// Whether there is a template of this name.
bool has_event_template(const std::string& name);

} // namespace evod::protocol
