// surefootd: the service behind a kiosk or a simulator channel. A thin main.
#include "systemd/daemon/daemon.hpp"

int main(int argc, char** argv) { return surefoot::daemon::run_main(argc, argv); }
