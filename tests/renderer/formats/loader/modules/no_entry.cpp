// A shared library that is not the module.
extern "C" int SomethingElse() {
  return 0;
}
