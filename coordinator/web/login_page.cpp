#include "coordinator/web/login_page.h"

#include "coordinator/web/html.h"

namespace tessera {

std::string LoginPage(const std::string& proof, const std::string& problem) {
  Html body;
  body.Open("main", {{"class", "login"}}).Element("h1", "Tessera farm");
  if (!problem.empty()) body.Element("p", problem, {{"class", "error"}, {"role", "alert"}});
  body.Open("form", {{"method", "post"}, {"action", "/login"}, {"autocomplete", "off"}});
  body.Void("input", {{"type", "hidden"}, {"name", "proof"}, {"value", proof}});
  body.Element("label", "Token from an operator", {{"for", "token"}});
  body.Void("input", {{"type", "password"},
                      {"name", "token"},
                      {"id", "token"},
                      {"autocomplete", "one-time-code"},
                      {"autofocus", ""},
                      {"required", ""}});
  body.Element("button", "Log in").Close();
  body.Element("p", "Operators make tokens with \"tessera-coordinator token\".", {{"class", "hint"}}).Close();
  return HtmlDocument("Log in", kLoginStyle, "", body.Take());
}

}  // namespace tessera
