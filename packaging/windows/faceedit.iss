; The installer for Windows, from dist\faceedit (Inno Setup 6). Prepared, never run:
;     iscc /DVersion=%VERSION% packaging\windows\faceedit.iss

[Setup]
AppId={{7C0E6B0E-52D8-4F0B-9C1E-0FACEED17001}
AppName=FaceEdit
AppVersion={#Version}
AppPublisher=The FaceEdit founders
LicenseFile=..\..\LICENSE
DefaultDirName={autopf}\FaceEdit
DefaultGroupName=FaceEdit
PrivilegesRequired=lowest
PrivilegesRequiredOverridesAllowed=dialog
ArchitecturesAllowed=x64compatible
ArchitecturesInstallIn64BitMode=x64compatible
ChangesAssociations=yes
SetupIconFile=..\..\build\packaging\icons\faceedit.ico
UninstallDisplayIcon={app}\faceedit.exe
OutputDir=..\..\dist
OutputBaseFilename=FaceEdit-{#Version}-windows-setup

[Files]
Source: "..\..\dist\faceedit\*"; DestDir: "{app}"; Flags: recursesubdirs ignoreversion

[Icons]
Name: "{group}\FaceEdit"; Filename: "{app}\faceedit.exe"

[Registry]
Root: HKA; Subkey: "Software\Classes\.faceedit"; ValueType: string; ValueData: "FaceEdit.Project"; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\FaceEdit.Project"; ValueType: string; ValueData: "FaceEdit project"; Flags: uninsdeletekey
Root: HKA; Subkey: "Software\Classes\FaceEdit.Project\DefaultIcon"; ValueType: string; ValueData: "{app}\faceedit.exe,0"
Root: HKA; Subkey: "Software\Classes\FaceEdit.Project\shell\open\command"; ValueType: string; ValueData: """{app}\faceedit.exe"" ""%1"""
; Takes stay with the programs that they belong to; FaceEdit is offered under "Open with".
Root: HKA; Subkey: "Software\Classes\.csv\OpenWithProgids"; ValueType: string; ValueName: "FaceEdit.Project"; ValueData: ""; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\.json\OpenWithProgids"; ValueType: string; ValueName: "FaceEdit.Project"; ValueData: ""; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\.glb\OpenWithProgids"; ValueType: string; ValueName: "FaceEdit.Project"; ValueData: ""; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\.tsv\OpenWithProgids"; ValueType: string; ValueName: "FaceEdit.Project"; ValueData: ""; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\.jsonl\OpenWithProgids"; ValueType: string; ValueName: "FaceEdit.Project"; ValueData: ""; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\.ndjson\OpenWithProgids"; ValueType: string; ValueName: "FaceEdit.Project"; ValueData: ""; Flags: uninsdeletevalue
