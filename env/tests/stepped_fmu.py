"""An FMU driven call by call through FMPy."""

import fmpy
from fmpy.fmi3 import FMU3Slave, fmi3False
from fmpy.model_description import read_model_description


class Slave:
    """An instance, driven call by call."""

    def __init__(self, fmu, folder, give_resources=True):
        self.folder = str(fmpy.extract(fmu, unzipdir=str(folder)))
        self.description = read_model_description(self.folder)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.log = []
        self.fmu = FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="rover",
        )
        self.callback = fmpy.fmi3.fmi3LogMessageCallback(self._log)
        path = (self.folder + "/resources/").encode() if give_resources else None
        self.fmu.component = self.fmu.fmi3InstantiateCoSimulation(
            b"rover",
            self.description.guid.encode(),
            path,
            fmi3False,
            True,
            fmi3False,
            fmi3False,
            None,
            0,
            None,
            self.callback,
            fmpy.fmi3.fmi3IntermediateUpdateCallback(),
        )
        assert self.fmu.component, self.log

    def _log(self, environment, status, category, message):
        self.log.append(message.decode())

    def start(self, **times):
        self.fmu.enterInitializationMode(**times)
        self.fmu.exitInitializationMode()

    def get(self, *names):
        return self.fmu.getFloat64([self.references[name] for name in names])

    def set(self, **values):
        for name, value in values.items():
            self.fmu.setFloat64([self.references[name]], [value])

    def free(self):
        self.fmu.fmi3FreeInstance(self.fmu.component)
        self.fmu.freeLibrary()
